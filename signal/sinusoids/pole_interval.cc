#include "signal/sinusoids/pole_interval.h"

#include <gsl/gsl_interp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <vector>

#include "signal/numerics/numbers.h"
#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Distances at which the likelihood is looked at, in standard uncertainties of the linear fit: as
// far as it takes.
constexpr std::array kLooks = {0.75, 1.5, 2.5, 4.0, 6.0, 9.0, 13.0, 19.0};
// Under exp(-9) of the density's top there is nothing more to see.
constexpr double kSpent = 9;
constexpr double kTail = 0.025;

/// 1 / (4 sinh^2(x / 2)) - 1 / x^2: under 1e-9 where the series is taken.
double spread_beside_pole(double x) {
  if (std::abs(x) < 0.1) return -1.0 / 12 + x * x / 240 - x * x * x * x / 6048;
  const double s = 2 * std::sinh(0.5 * x);
  return 1 / (s * s) - 1 / (x * x);
}

class HeldPole {
 public:
  HeldPole(const Eigen::Ref<const Eigen::VectorXd>& y, std::span<const Index> missing,
           const DampedSinusoidsFit& fit, Index part, const PoleEvidence& evidence)
      : y_(y),
        missing_(missing),
        fit_(fit),
        part_(part),
        mode_(static_cast<std::size_t>(part / 2)),
        evidence_(evidence) {
    const Index parameter = 4 * (part / 2) + 2 + part % 2;
    variance_ = evidence.std * evidence.std / fit.unit_covariance(parameter, parameter);
  }

  /// Distances, with their sign, and what the likelihood has lost there: s^2 = R^2 - r^2.
  struct Looks {
    std::vector<double> distance, rise;
  };
  Looks look(double sign) const {
    Looks looks;
    std::vector<Complex> poles = fit_.poles;
    DampedSinusoidsOptions held;
    held.held = part_;
    for (const double distance : kLooks) {
      Complex& pole = poles[mode_];
      const double value = centre() + sign * distance * evidence_.std;
      pole = real() ? Complex(value, pole.imag()) : Complex(pole.real(), value);
      if (!plausible_decay(pole, fit_.samples) || pole.imag() > 0.5 * kTwoPi) break;
      const DampedSinusoidsFit at = fit_damped_sinusoids(y_, poles, held, missing_);
      const double rise = (at.residual_sum_squares - fit_.residual_sum_squares) / variance_;
      if (!std::isfinite(rise)) break;
      poles = at.poles;
      looks.distance.push_back(sign * distance);
      looks.rise.push_back(std::max(0.0, rise));
      if (loss(looks.rise.back()) > kSpent) break;
    }
    return looks;
  }

  /// log g, but for a constant.
  double log_density(double distance, double rise) const {
    const double degrees = static_cast<double>(fit_.degrees);
    const double law = -0.5 * (degrees + 1) * std::log1p(2 * loss(rise) / degrees);
    // Laplace's approximation of the phase needs mu r over 1.
    const double r = std::max(root(rise), 1 / std::max(evidence_.strength, 1e-3));
    return law - std::log(r) + 0.5 * tilt(distance);
  }

 private:
  bool real() const { return part_ % 2 == 0; }
  double centre() const { return real() ? fit_.poles[mode_].real() : fit_.poles[mode_].imag(); }
  double root(double rise) const { return std::sqrt(std::max(0.0, evidence_.energy - rise)); }
  /// mu (R - r)
  double loss(double rise) const {
    return evidence_.strength * std::min(rise, evidence_.energy) /
           (std::sqrt(evidence_.energy) + root(rise));
  }
  double tilt(double distance) const {
    if (!real()) return 0;
    const double a = -centre(), at = a - distance * evidence_.std;
    return std::log(index_variance(2 * at, fit_.samples) / index_variance(at + a, fit_.samples));
  }

  const Eigen::Ref<const Eigen::VectorXd>& y_;
  std::span<const Index> missing_;
  const DampedSinusoidsFit& fit_;
  Index part_;
  std::size_t mode_;
  const PoleEvidence& evidence_;
  double variance_ = 0;
};

}  // namespace

double index_variance(double q, Index n) {
  // 1 / (4 sinh^2(q / 2)) - n^2 / (4 sinh^2(n q / 2)), whose poles at q = 0 cancel.
  const double count = static_cast<double>(n);
  return spread_beside_pole(q) - count * count * spread_beside_pole(count * q);
}

PoleInterval pole_interval(const Eigen::Ref<const Eigen::VectorXd>& y,
                           std::span<const Index> missing, const DampedSinusoidsFit& fit,
                           Index part, const PoleEvidence& evidence) {
  const HeldPole held(y, missing, fit, part, evidence);
  const auto below = held.look(-1), above = held.look(1);
  // The rise over the distance's square changes slowly: it is what is interpolated.
  std::vector<double> at, slope;
  for (std::size_t k = below.distance.size(); k-- > 0;) {
    at.push_back(below.distance[k]);
    slope.push_back(below.rise[k] / (at.back() * at.back()));
  }
  at.push_back(0), slope.push_back(1);
  for (std::size_t k = 0; k < above.distance.size(); ++k) {
    at.push_back(above.distance[k]);
    slope.push_back(above.rise[k] / (at.back() * at.back()));
  }
  if (at.size() < 3) return {kLooks.back(), kLooks.back(), false};
  const std::unique_ptr<gsl_interp, void (*)(gsl_interp*)> curve(
      gsl_interp_alloc(gsl_interp_steffen, at.size()), gsl_interp_free);
  gsl_interp_init(curve.get(), at.data(), slope.data(), at.size());

  constexpr double kStep = 0.02;
  const double low = at.front(), high = at.back();
  const auto steps = static_cast<std::size_t>(std::ceil((high - low) / kStep));
  const double step = (high - low) / static_cast<double>(steps);
  std::vector<double> density(steps + 1), mass(steps + 1, 0);
  for (std::size_t k = 0; k <= steps; ++k) {
    const double x = std::min(low + step * static_cast<double>(k), high);
    density[k] = held.log_density(
        x, x * x * gsl_interp_eval(curve.get(), at.data(), slope.data(), x, nullptr));
  }
  const double top = *std::max_element(density.begin(), density.end());
  for (double& d : density) d = std::exp(d - top);
  for (std::size_t k = 1; k <= steps; ++k) {
    mass[k] = mass[k - 1] + 0.5 * step * (density[k - 1] + density[k]);
  }
  const auto where = [&](double share) {
    const double wanted = share * mass.back();
    const auto k = std::clamp<std::size_t>(
        static_cast<std::size_t>(std::lower_bound(mass.begin(), mass.end(), wanted) - mass.begin()),
        1, steps);
    return low + step * (static_cast<double>(k - 1) +
                         (wanted - mass[k - 1]) / std::max(mass[k] - mass[k - 1], 1e-300));
  };
  PoleInterval interval;
  interval.below = std::max(0.0, -where(kTail));
  interval.above = std::max(0.0, where(1 - kTail));
  interval.bounded =
      density.front() * -low < 0.01 * mass.back() && density.back() * high < 0.01 * mass.back();
  return interval;
}

}  // namespace rigfit::signal
