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

AbscissaEffect abscissa_effect(const Eigen::Ref<const Eigen::MatrixXd>& covariance,
                               double variance_factor,
                               const Eigen::Ref<const Eigen::MatrixXd>& jacobian,
                               const Eigen::Ref<const Eigen::VectorXd>& sigma,
                               const Eigen::Ref<const Eigen::VectorXd>& change) {
  const Eigen::VectorXd relative = change.cwiseQuotient(sigma);
  const Eigen::MatrixXd A = covariance / variance_factor * jacobian.transpose();
  const Eigen::VectorXd own = variance_factor * (1 - relative.array().square());
  AbscissaEffect effect;
  effect.by_tension = A * relative;
  effect.covariance = A * own.asDiagonal() * A.transpose();
  effect.covariance += effect.by_tension * effect.by_tension.transpose();
  return effect;
}

}  // namespace rigfit::ident
