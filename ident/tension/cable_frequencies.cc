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
  /// Newton from `near` (0: unknown); where that does not end, a fixed point, the right side
  /// positive, with Aitken's extrapolation.
  [[nodiscard]] double straight(int n, double near, double last_step) const {
    const double base = (n + 1) * kPi / 2;
    const bool symmetric = n % 2 == 0;
    if (near > base && near < base + kPi / 2) {
      double b = near;
      for (int i = 0; i < kNewtonSteps; ++i) {
        const auto right = right_side(b, symmetric);
        const double step = (b - base - std::atan(right.value)) /
                            (1 - right.slope / (1 + right.value * right.value));
        b -= step;
        if (!(b >= base && b <= base + kPi / 2)) break;
        if (std::abs(step) < last_step * b) return b;
      }
    }
    const auto next = [&](double b) { return base + std::atan(right_side(b, symmetric).value); };
    double b = next(base);
    for (int i = 0; i < 50; ++i) {
      const double first = next(b), second = next(first);
      const double step = first - b, bend = second - 2 * first + b;
      if (std::abs(second - first) < 1e-13 * b || bend == 0) return second;
      b = std::clamp(b - step * step / bend, base, base + kPi / 2);
    }
    return b;
  }

  /// Root between two neighbouring symmetric ones without sag, the only one there. Newton from
  /// `near` (0: unknown), else a bracketed search.
  [[nodiscard]] double sagging(double low, double high, double near, double last_step) const {
    double b = near > low && near < high ? near : low;
    for (int i = 0; i < kNewtonSteps; ++i) {
      const auto here = misfit(b);
      const double step = here.value / here.slope;
      b -= step;
      if (!(b > low * (1 - kRounding) && b < high)) break;
      if (std::abs(step) < last_step * b) return std::max(b, low);
    }
    return bracketed(low, high);
  }

  [[nodiscard]] bool sags() const { return sag_ > 0; }

 private:
  struct Value {
    double value = 0, slope = 0;  ///< slope: d / d b
  };
  /// tanh a and 1 - tanh^2 a. a >= pi / 2: no cancellation.
  static Value hyperbolic_tangent(double a) {
    if (a > 20) return {1, 0};
    const double e = std::exp(2 * a) + 1;
    return {1 - 2 / e, 4 * (e - 1) / (e * e)};
  }

  [[nodiscard]] double bracketed(double low, double high) const {
    double at_low = misfit(low).value, at_high = misfit(high).value;
    if (at_low == 0 || (at_low > 0) == (at_high > 0)) return low;
    int side = 0;
    for (int i = 0; i < 100 && high - low > 1e-13 * high; ++i) {  // Illinois
      const double middle = (at_high * low - at_low * high) / (at_high - at_low);
      const double here = misfit(middle).value;
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

  [[nodiscard]] Value right_side(double b, bool symmetric) const {
    const double a = std::sqrt(b * b + ratio_);
    const auto t = hyperbolic_tangent(a);
    const double H = symmetric ? a * t.value : a / t.value;
    const double dH =
        symmetric ? b / a * (t.value + a * t.slope) : b / a * (1 - a * t.slope / t.value) / t.value;
    if (std::isinf(spring_)) return {b / H, (H - b * dH) / (H * H)};
    const double D = a * a + b * b + spring_ * H, dD = 4 * b + spring_ * dH;
    return {spring_ * b / D, spring_ * (D - b * dD) / (D * D)};
  }

  [[nodiscard]] Value misfit(double b) const {
    const double a = std::sqrt(b * b + ratio_), c = std::cos(b), s = std::sin(b);
    const auto t = hyperbolic_tangent(a);
    const double H = a * t.value, dH = b / a * (t.value + a * t.slope);
    const bool clamped = std::isinf(spring_);
    const double N = clamped ? b * s : b * (b * c + spring_ * s),
                 dN = clamped ? s + b * c : 2 * b * c - b * b * s + spring_ * (s + b * c),
                 M = clamped ? H : a * a + spring_ * H, dM = clamped ? dH : 2 * b + spring_ * dH;
    const double share = N / M, dshare = (dN - share * dM) / M;
    const double inertia = b * b * (1 + b * b / ratio_),
                 dinertia = 2 * b * (1 + 2 * b * b / ratio_);
    const double t_a = t.value / a, dt_a = b / (a * a) * (t.slope - t_a);
    return {(share + c) * (inertia - sag_) + sag_ * (share * t_a + s / b),
            (dshare - s) * (inertia - sag_) + (share + c) * dinertia +
                sag_ * (dshare * t_a + share * dt_a + (c - s / b) / b)};
  }

  static constexpr int kNewtonSteps = 6;
  static constexpr double kRounding = 1e-12;  ///< of a root that sag does not move

  double half_, ratio_, spring_, sag_, scale_;
};

}  // namespace

CableFrequencies cable_frequencies(const SaggingBeam& cable, int count, double limit_hz,
                                   CableRoots* near) {
  const HalfBeam beam(cable);
  CableRoots own;
  CableRoots& roots = near != nullptr ? *near : own;
  CableFrequencies found;
  const auto straight = [&](int n) {
    const auto i = static_cast<std::size_t>(n);
    if (roots.straight.size() <= i) roots.straight.resize(i + 1, 0);
    double& b = roots.straight[i];
    if (b == 0 && n > 0) b = roots.straight[i - 1] + kPi / 2;
    return b = beam.straight(n, b, roots.last_step);
  };
  std::size_t sagging_count = 0;
  const auto sagging = [&](double low, double high) {
    if (roots.sagging.size() <= sagging_count) roots.sagging.push_back(0);
    double& b = roots.sagging[sagging_count++];
    return b = beam.sagging(low, high, b, roots.last_step);
  };
  double symmetric = 0;  // the last symmetric root
  for (int n = 0; n < count; ++n) {
    const double b = straight(n), frequency = beam.frequency_hz(b);
    found.out_hz.push_back(frequency);
    if (!beam.sags() || n % 2 == 1) found.in_hz.push_back(frequency);
    if (n % 2 == 0) {
      if (beam.sags() && n > 0) found.in_hz.push_back(beam.frequency_hz(sagging(symmetric, b)));
      symmetric = b;
    }
    if (frequency >= limit_hz) break;
  }
  const auto modes = static_cast<int>(found.out_hz.size());
  if (beam.sags()) {  // the last symmetric root's own upper neighbour
    const int next = modes % 2 == 1 ? modes + 1 : modes;
    found.in_hz.push_back(beam.frequency_hz(sagging(symmetric, straight(next))));
    std::sort(found.in_hz.begin(), found.in_hz.end());
  }
  return found;
}

}  // namespace rigfit::ident
