#include "ident/stiffness/tension_spread.h"

#include <algorithm>
#include <cmath>

namespace rigfit::ident {

double tension_spread(const Eigen::Ref<const Eigen::VectorXd>& tension, double noise) {
  if (tension.size() == 0) return 0;
  // The largest of n normal deviates is about sqrt(2 ln n).
  const double extreme = noise * std::sqrt(2 * std::log(static_cast<double>(tension.size())));
  const double low = tension.minCoeff() + extreme, high = tension.maxCoeff() - extreme;
  if (!(high > low)) return 0;
  const double mean = std::clamp(tension.mean(), low, high);
  return std::hypot(0.5 * (low + high) - mean, (high - low) / std::sqrt(12.0));
}

std::vector<double> change_by_tension(const std::vector<StiffnessPoint>& points) {
  std::vector<double> change(points.size(), 0.0);
  if (points.empty()) return change;
  const auto [low, high] =
      std::minmax_element(points.begin(), points.end(),
                          [](const auto& a, const auto& b) { return a.tension_N < b.tension_N; });
  if (!(high->tension_N > 1.05 * low->tension_N)) return change;
  double x_mean = 0, y_mean = 0;
  for (const auto& point : points) {
    x_mean += std::log(point.tension_N), y_mean += std::log(point.EI_Nm2);
  }
  x_mean /= static_cast<double>(points.size()), y_mean /= static_cast<double>(points.size());
  double xx = 0, xy = 0;
  for (const auto& point : points) {
    const double x = std::log(point.tension_N) - x_mean;
    xx += x * x, xy += x * (std::log(point.EI_Nm2) - y_mean);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double slope = xy / xx * points[i].EI_Nm2 / points[i].tension_N;
    change[i] = slope * points[i].tension_std_N;
  }
  return change;
}

double own_std(const StiffnessPoint& point) {
  const double whole = std::isfinite(point.low) && std::isfinite(point.high)
                           ? (point.high - point.low) / (2 * 1.959964)
                           : point.std;
  const double shared = point.shared_relative_std * point.EI_Nm2;
  return std::sqrt(std::max(whole * whole - shared * shared, 1e-6 * whole * whole));
}

}  // namespace rigfit::ident
