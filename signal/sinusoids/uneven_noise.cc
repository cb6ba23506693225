#include "signal/sinusoids/uneven_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rigfit::signal {
namespace {

using Eigen::Index;

// Samples that are gone through at a time.
constexpr Index kBlock = 256;
// The normal distribution exceeds it once in a thousand times.
constexpr double kUneven = 3.09;

struct Innovations {
  Eigen::VectorXd values;
  std::vector<bool> known;  ///< false where one of the samples that it is made of is missing
};

Innovations innovations(const Eigen::VectorXd& residual, const Eigen::VectorXd& coefficients) {
  Innovations e{residual, std::vector<bool>(static_cast<std::size_t>(residual.size()))};
  const Index order = coefficients.size();
  Index present = 0;  // samples up to j without a gap
  for (Index j = 0; j < residual.size(); ++j) {
    present = residual(j) != 0 ? present + 1 : 0;
    e.known[static_cast<std::size_t>(j)] = present > order;
    for (Index k = 1; k <= std::min(order, j); ++k) {
      e.values(j) -= coefficients(k - 1) * residual(j - k);
    }
  }
  return e;
}

}  // namespace

double UnevenNoise::widening(Index k) const {
  return deviation(k) > kUneven ? std::max(1.0, variance_ratio(k)) : 1;
}

Eigen::MatrixXd UnevenNoise::widened(const Eigen::Ref<const Eigen::MatrixXd>& covariance) const {
  Eigen::VectorXd factor(covariance.rows());
  for (Index k = 0; k < factor.size(); ++k) factor(k) = std::sqrt(widening(k));
  return factor.asDiagonal() * covariance * factor.asDiagonal();
}

UnevenNoise uneven_noise(const DampedSinusoidsFit& fit, const ResidualNoise& noise) {
  const Index order = noise.coefficients.size(), parameters = fit.unit_covariance.rows();
  const double variance = noise.innovation_variance;
  const Innovations e = innovations(fit.residual, noise.coefficients);
  Eigen::ArrayXd w = Eigen::ArrayXd::Zero(parameters), weights = w, squared_weights = w, with_e = w;
  double count = 0, squares = 0, fourth_powers = 0;
  // Filtered from the end on: behind the rows of a block stand those of the next that it needs.
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(kBlock + order, parameters);
  for (Index start = (fit.samples - 1) / kBlock * kBlock; start >= 0; start -= kBlock) {
    const Index length = std::min(kBlock, fit.samples - start);
    const Eigen::MatrixXd jacobian = fit.jacobian_rows(start, length);
    const Eigen::MatrixXd influence = jacobian * fit.unit_covariance;
    const Eigen::MatrixXd behind = rows.topRows(order);
    rows.topRows(length) = influence;
    rows.middleRows(length, order) = behind;
    for (Index l = length - 1; l >= 0; --l) {
      for (Index k = 1; k <= order; ++k) rows.row(l) += noise.coefficients(k - 1) * rows.row(l + k);
      const Index j = start + l;
      if (!e.known[static_cast<std::size_t>(j)]) continue;
      const double leverage = std::min(jacobian.row(l).dot(influence.row(l)), 0.99);
      const double square = e.values(j) * e.values(j) / (1 - leverage);
      w = rows.row(l).transpose().array().square();
      weights += w, squared_weights += w.square(), with_e += square * w;
      ++count, squares += square, fourth_powers += square * square;
    }
  }
  UnevenNoise uneven;
  const double scatter = fourth_powers - squares * squares / std::max(count, 1.0);
  uneven.variance_ratio = with_e / (variance * weights).max(1e-300);
  uneven.deviation =
      (with_e - variance * weights) /
      ((squared_weights - weights.square() / count) * scatter / count).max(1e-300).sqrt();
  return uneven;
}

}  // namespace rigfit::signal
