#include "signal/profile_interval.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

namespace rigfit::signal {

using Complex = std::complex<double>;
using Eigen::Index;

ProfileInterval profile_interval(const Eigen::Ref<const Eigen::VectorXd>& y,
                                 std::span<const Index> missing, const DampedSinusoidsFit& fit,
                                 Index part, double std, double factor) {
  const auto mode = static_cast<std::size_t>(part / 2);
  const Index parameter = 4 * (part / 2) + 2 + part % 2;
  const double centre = part % 2 == 0 ? fit.poles[mode].real() : fit.poles[mode].imag();
  // Of a linear fit in white noise RSS rises by (theta - centre)^2 over this.
  const double unit = fit.unit_covariance(parameter, parameter);
  DampedSinusoidsOptions held;
  held.held = part;
  ProfileInterval interval;
  const double linear = factor * std;
  const auto distance = [&](double sign) {
    const double wanted = factor * std / std::sqrt(unit);  // root of the rise
    std::vector<Complex> poles = fit.poles;
    const auto root_of_rise = [&](double offset) {
      const double value = centre + sign * offset;
      poles[mode] =
          part % 2 == 0 ? Complex(value, poles[mode].imag()) : Complex(poles[mode].real(), value);
      const DampedSinusoidsFit at = fit_damped_sinusoids(y, poles, held, missing);
      poles = at.poles;
      return std::sqrt(std::max(0.0, at.residual_sum_squares - fit.residual_sum_squares));
    };
    // The root rises in proportion but for curvature: false position from 0 converges in a few
    // steps; beyond four times the linear answer the data do not bound the value.
    const double farthest = 4 * linear;
    double low = 0, low_value = 0, high = linear, high_value = root_of_rise(high);
    while (high_value < wanted) {
      if (high >= farthest) {
        interval.bounded = false;
        return high;
      }
      low = high, low_value = high_value;
      high = std::min(1.5 * high, farthest);
      high_value = root_of_rise(high);
    }
    double at = high;
    for (int step = 0; step < 8; ++step) {
      const double share = (wanted - low_value) / (high_value - low_value);
      at = low + std::clamp(share, 0.02, 0.98) * (high - low);
      const double value = root_of_rise(at);
      if (std::abs(value - wanted) < 1e-3 * wanted) break;
      if (value < wanted) {
        low = at, low_value = value;
      } else {
        high = at, high_value = value;
      }
    }
    return at;
  };
  interval.below = distance(-1) / linear;
  interval.above = distance(1) / linear;
  return interval;
}

}  // namespace rigfit::signal
