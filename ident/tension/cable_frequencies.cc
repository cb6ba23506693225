#include "ident/tension/cable_frequencies.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "ident/statistics/root.h"

namespace rigfit::ident {
namespace {

constexpr double kPi = std::numbers::pi;

/// A number and its derivative with respect to the wave number.
using Slope = ceres::Jet<double, 1>;

/// The beam in half its length: wave numbers times L / 2.
class HalfBeam {
 public:
  explicit HalfBeam(const SaggingBeam& cable)
      : half_(cable.length_m / 2),
        ratio_(cable.tension_N * half_ * half_ / cable.EI_Nm2),
        spring_(cable.spring_Nm_rad * half_ / cable.EI_Nm2),
        sag_(cable.lambda_squared / 4),
        scale_(std::sqrt(cable.tension_N / cable.mass_per_length) / (2 * kPi * half_)) {
    if (sag_ > 0) shape();
  }

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
        const double step =
            (b - base - std::atan(right.a)) / (1 - right.v[0] / (1 + right.a * right.a));
        b -= step;
        if (!(b >= base && b <= base + kPi / 2)) break;
        if (std::abs(step) < last_step * b) return b;
      }
    }
    const auto next = [&](double b) { return base + std::atan(right_side(b, symmetric).a); };
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
      const double step = here.a / here.v[0];
      b -= step;
      if (!(b > low * (1 - kRounding) && b < high)) break;
      if (std::abs(step) < last_step * b) return std::max(b, low);
    }
    const double root = root_between(low, high, 1e-13, [this](double x) { return misfit(x).a; });
    return std::isfinite(root) ? root : low;
  }

  [[nodiscard]] bool sags() const { return sag_ > 0; }

 private:
  /// Sets the static curve's terms: p = 1 - cosh(kappa x) / cosh(kappa), half the span 1.
  void shape() {
    kappa_ = std::sqrt(ratio_);
    tanh_kappa_ = std::tanh(kappa_);
    const double sech2 = kappa_ > 20 ? 0 : 1 - tanh_kappa_ * tanh_kappa_;
    squared_ = 1 - 1.5 * tanh_kappa_ / kappa_ + sech2 / 2;
  }

  [[nodiscard]] Slope right_side(double at, bool symmetric) const {
    const Slope b(at, 0), a = sqrt(b * b + ratio_), t = tanh(a);
    const Slope H = symmetric ? a * t : a / t;
    if (std::isinf(spring_)) return b / H;
    return spring_ * b / (a * a + b * b + spring_ * H);
  }

  /// The determinant of the header.
  [[nodiscard]] Slope misfit(double at) const {
    const Slope b(at, 0), a = sqrt(b * b + ratio_), t = tanh(a), c = cos(b), s = sin(b);
    Slope S, R;
    if (std::isinf(spring_)) {
      S = c + b * s / (a * t);
      R = kappa_ * tanh_kappa_ / (a * t);
    } else {
      const Slope M = a * a + spring_ * a * t;
      S = c + b * (b * c + spring_ * s) / M;
      R = kappa_ * (kappa_ + spring_ * tanh_kappa_) / M;
    }
    const Slope of_cos = s / b - (kappa_ * tanh_kappa_ * c + b * s) / (b * b + ratio_);
    // (a tanh a - kappa tanh kappa) / (a^2 - kappa^2), tanh a - tanh kappa without cancellation.
    const Slope apart = b * b / (a + kappa_);  // a - kappa
    Slope both = t;
    if (const Slope differ = 1.0 - t * tanh_kappa_; differ.a > 1e-15) {
      both = both + kappa_ * (tanh(apart) * differ / apart);
    }
    const Slope of_cosh = t / a - both / (a + kappa_);
    const Slope inertia = b * b * ((1 / ratio_) * b * b + 1.0);
    return S * (inertia + -sag_ * squared_) + sag_ * (R * (of_cos - c * of_cosh));
  }

  static constexpr int kNewtonSteps = 6;
  /// Relative rounding of a root that sag does not move.
  static constexpr double kRounding = 1e-12;

  double half_, ratio_, spring_, sag_, scale_;
  double kappa_ = 0, tanh_kappa_ = 0, squared_ = 0;  ///< shape(); squared_: mean of p^2
};

}  // namespace

CableFrequencies cable_frequencies(const SaggingBeam& cable, int count, double limit_hz,
                                   CableRoots* near) {
  CableRoots own;
  CableRoots& roots = near != nullptr ? *near : own;
  CableFrequencies found;
  SaggingBeam mirrored = cable;
  if (cable.first_pinned) {
    mirrored.length_m *= 2;
    mirrored.lambda_squared = 0;
  }
  const HalfBeam beam(mirrored);
  const auto straight = [&](int n) {
    const auto i = static_cast<std::size_t>(n);
    if (roots.straight.size() <= i) roots.straight.resize(i + 1, 0);
    double& b = roots.straight[i];
    if (b == 0 && n > 0) b = roots.straight[i - 1] + (cable.first_pinned ? kPi : kPi / 2);
    return b = beam.straight(cable.first_pinned ? 2 * n + 1 : n, b, roots.last_step);
  };
  if (cable.first_pinned) {
    for (int n = 0; n < count; ++n) {
      found.out_hz.push_back(beam.frequency_hz(straight(n)));
      if (found.out_hz.back() >= limit_hz) break;
    }
    found.in_hz = found.out_hz;
    if (cable.lambda_squared > 0) {
      SaggingBeam pinned = cable;
      pinned.first_pinned = false;
      pinned.spring_Nm_rad = 0;
      const auto modes = static_cast<int>(found.out_hz.size());
      const auto hung =
          cable_frequencies(pinned, modes, std::numeric_limits<double>::infinity(), nullptr);
      for (std::size_t i = 0; i < found.in_hz.size(); ++i) {
        found.in_hz[i] *= hung.in_hz[i] / hung.out_hz[i];
      }
    }
    return found;
  }
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
    if (beam.sags() && n % 2 == 0) {
      if (n > 0)
        found.in_hz[static_cast<std::size_t>(n) - 2] = beam.frequency_hz(sagging(symmetric, b));
      symmetric = b;
    }
    found.in_hz.push_back(frequency);
    if (frequency >= limit_hz) break;
  }
  if (beam.sags()) {  // the last symmetric root's own upper neighbour
    const auto modes = static_cast<int>(found.out_hz.size());
    const int next = modes % 2 == 1 ? modes + 1 : modes;
    found.in_hz[static_cast<std::size_t>(next) - 2] =
        beam.frequency_hz(sagging(symmetric, straight(next)));
  }
  return found;
}

}  // namespace rigfit::ident
