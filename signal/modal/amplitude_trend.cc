#include "signal/modal/amplitude_trend.h"

#include <gsl/gsl_cdf.h>

#include <Eigen/Core>
#include <cmath>

namespace rigfit::signal {

AmplitudeTrend amplitude_trend(const IdentifiedMode& mode) {
  using Eigen::ArrayXd;
  using Eigen::Index;
  AmplitudeTrend trend;
  constexpr Index kFewest = 5;
  const auto n = static_cast<Index>(mode.points.size());
  if (n < kFewest) return trend;
  const Eigen::VectorXcd& shape = mode.participation;
  ArrayXd x(n), y(n), weight(n);
  const double scatter = mode.between_points_std_hz, mean = mode.frequency_hz.value;
  for (Index i = 0; i < n; ++i) {
    const ModeAtPoint& point = mode.points[static_cast<std::size_t>(i)];
    if (point.order >= shape.size()) return trend;
    x[i] = std::norm(shape[point.order]);
    y[i] = point.frequency_hz.value - mean;
    const double variance = std::pow(point.frequency_hz.std, 2) + scatter * scatter;
    if (!(variance > 0)) return trend;
    weight[i] = 1 / variance;
  }
  const double strongest = x.maxCoeff();
  if (!(strongest > 0)) return trend;
  x /= strongest;
  const double total = weight.sum(), middle = (weight * x).sum() / total;
  const double level = (weight * y).sum() / total;
  const ArrayXd away = x - middle;
  const double spread = (weight * away.square()).sum();
  if (!(spread > 1e-6 * total)) return trend;
  const double slope = (weight * away * y).sum() / spread;
  const double left = (weight * (y - level - slope * away).square()).sum();
  const double freedom = static_cast<double>(n - 2);
  const double std = std::sqrt(left / freedom / spread);
  trend.chance = std > 0 ? 2 * gsl_cdf_tdist_Q(std::abs(slope) / std, freedom) : 0;
  trend.small_hz = mean + level - slope * middle;
  trend.strongest_hz = trend.small_hz + slope;
  return trend;
}

}  // namespace rigfit::signal
