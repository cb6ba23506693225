#include "ident/tension/cable_frequencies.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigfit::ident {
namespace {

constexpr double kPi = std::numbers::pi;

/// The beam in half its length: wave numbers times L / 2.
class HalfBeam {
 public:
  explicit HalfBeam(const SaggingBeam& cable)
      : half_(cable.length_m / 2),
        ratio_(cable.tension_N * half_ * half_ / cable.EI_Nm2),
        spring_(cable.spring_Nm_rad * half_ / cable.EI_Nm2),
        sag_(cable.lambda_squared / 4),
        scale_(std::sqrt(cable.tension_N / cable.mass_per_length) / (2 * kPi * half_)) {}

  [[nodiscard]] double frequency_hz(double b) const {
    return scale_ * b * std::sqrt(1 + b * b / ratio_);
  }

  /// Root n of the beam without sag: n = 0 the first symmetric one, 1 the first antisymmetric one.
  /// A fixed point, the right side positive; Aitken's extrapolation makes it quadratic.
  [[nodiscard]] double straight(int n) const {
    const double base = (n + 1) * kPi / 2;
    const auto next = [&](double b) { return base + std::atan(right_side(b, n % 2 == 0)); };
    double b = next(base);
    for (int i = 0; i < 50; ++i) {
      const double first = next(b), second = next(first);
      const double step = first - b, bend = second - 2 * first + b;
      if (std::abs(second - first) < 1e-13 * b || bend == 0) return second;
      b = std::clamp(b - step * step / bend, base, base + kPi / 2);
    }
    return b;
  }

  /// Root between two neighbouring symmetric ones without sag.
  [[nodiscard]] double sagging(double low, double high) const {
    double at_low = misfit(low), at_high = misfit(high);
    if (at_low == 0 || (at_low > 0) == (at_high > 0)) return low;
    int side = 0;
    for (int i = 0; i < 100 && high - low > 1e-13 * high; ++i) {  // Illinois
      const double middle = (at_high * low - at_low * high) / (at_high - at_low);
      const double here = misfit(middle);
      if (here == 0) return middle;
      if ((here > 0) == (at_high > 0)) {
        if (high - middle < 1e-14 * high && side == 1) return middle;
        high = middle;
        at_high = here;
        if (side == 1) at_low /= 2;
        side = 1;
      } else {
        if (middle - low < 1e-14 * high && side == -1) return middle;
        low = middle;
        at_low = here;
        if (side == -1) at_high /= 2;
        side = -1;
      }
    }
    return (low + high) / 2;
  }

  [[nodiscard]] bool sags() const { return sag_ > 0; }

 private:
  /// To the last digit.
  static double hyperbolic_tangent(double a) { return a > 20 ? 1 : std::tanh(a); }

  [[nodiscard]] double right_side(double b, bool symmetric) const {
    const double a = std::sqrt(b * b + ratio_), t = hyperbolic_tangent(a);
    const double hyperbolic = symmetric ? a * t : a / t;
    if (std::isinf(spring_)) return b / hyperbolic;
    return spring_ * b / (a * a + b * b + spring_ * hyperbolic);
  }

  [[nodiscard]] double misfit(double b) const {
    const double a = std::sqrt(b * b + ratio_), t = hyperbolic_tangent(a), c = std::cos(b),
                 s = std::sin(b);
    const double share = std::isinf(spring_)
                             ? b * s / (a * t)
                             : (b * b * c + spring_ * b * s) / (a * a + spring_ * a * t);
    const double inertia = b * b * (1 + b * b / ratio_);
    return (share + c) * (inertia - sag_) + sag_ * (share * t / a + s / b);
  }

  double half_, ratio_, spring_, sag_, scale_;
};

}  // namespace

CableFrequencies cable_frequencies(const SaggingBeam& cable, int count, double limit_hz) {
  const HalfBeam beam(cable);
  CableFrequencies found;
  double symmetric = 0;  // the last symmetric root
  for (int n = 0; n < count; ++n) {
    const double b = beam.straight(n), frequency = beam.frequency_hz(b);
    found.out_hz.push_back(frequency);
    if (!beam.sags() || n % 2 == 1) found.in_hz.push_back(frequency);
    if (n % 2 == 0) {
      if (beam.sags() && n > 0) {
        found.in_hz.push_back(beam.frequency_hz(beam.sagging(symmetric, b)));
      }
      symmetric = b;
    }
    if (frequency >= limit_hz) break;
  }
  const auto modes = static_cast<int>(found.out_hz.size());
  if (beam.sags()) {  // the last symmetric root's own upper neighbour
    const int next = modes % 2 == 1 ? modes + 1 : modes;
    found.in_hz.push_back(beam.frequency_hz(beam.sagging(symmetric, beam.straight(next))));
    std::sort(found.in_hz.begin(), found.in_hz.end());
  }
  return found;
}

}  // namespace rigfit::ident
