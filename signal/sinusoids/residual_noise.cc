#include "signal/sinusoids/residual_noise.h"

#include <Eigen/Cholesky>

namespace rigfit::signal {

double ResidualNoise::white_equivalent(double frequency) const {
  Complex a = 1;
  for (Index k = 0; k < coefficients.size(); ++k) {
    a -= coefficients(k) *
         std::polar(1.0, -2 * std::numbers::pi * frequency * static_cast<double>(k + 1));
  }
  return innovation_variance / std::norm(a);
}

namespace {

// Samples that are gone through at a time.
constexpr Index kNoiseBlock = 256;
// The normal distribution exceeds it once in a thousand times.
constexpr double kUneven = 3.09;

/// Autocovariance matrix of `order` + 1 neighbouring samples, sums of products. The ridge is beyond
/// what rounding takes off its smallest pivot.
MatrixXd autocovariance(const Ref<const VectorXd>& x, Index order) {
  VectorXd lags(order + 1);
  for (Index k = 0; k <= order; ++k) lags(k) = x.head(x.size() - k).dot(x.tail(x.size() - k));
  MatrixXd covariance = MatrixXd::NullaryExpr(
      order + 1, order + 1, [&](Index i, Index j) { return lags(std::abs(i - j)); });
  covariance.diagonal().array() *= 1 + 1e-12;
  return covariance;
}

/// Sums of squares that autoregressions of order 0, 1, ... leave: the squared pivots.
ArrayXd prediction_errors(const MatrixXd& covariance) {
  return covariance.llt().matrixLLT().diagonal().array().square();
}

}  // namespace

ResidualNoise residual_noise(const Ref<const VectorXd>& residual, Index degrees) {
  ResidualNoise noise;
  const double sum = residual.squaredNorm();
  noise.variance = noise.innovation_variance =
      sum / static_cast<double>(std::max<Index>(degrees, 1));
  // The fit itself takes a notch out of the spectrum; an order that could follow it is not allowed.
  const Index highest = std::min<Index>(24, degrees / 25);
  if (highest < 1 || !(sum > 0)) return noise;
  const MatrixXd covariance = autocovariance(residual, highest);
  const ArrayXd errors = prediction_errors(covariance);
  const auto count = static_cast<double>(degrees);
  Index order = 0;
  (count * errors.log() +
   std::log(count) * ArrayXd::LinSpaced(highest + 1, 0, static_cast<double>(highest)))
      .minCoeff(&order);
  if (order == 0) return noise;
  noise.coefficients =
      covariance.topLeftCorner(order, order).llt().solve(covariance.col(0).segment(1, order));
  noise.innovation_variance *= errors(order) / sum;
  return noise;
}

FitUncertainty fit_uncertainty(const DampedSinusoidsFit& fit, const ResidualNoise& noise) {
  const Index order = noise.coefficients.size(), parameters = fit.unit_covariance.rows();
  const double variance = noise.innovation_variance;
  ArrayXd w = ArrayXd::Zero(parameters), weights = w, squared_weights = w, with_e = w;
  MatrixXd products = MatrixXd::Zero(parameters, parameters);
  double count = 0, squares = 0, fourth_powers = 0;
  // Filtered from the end on: behind the rows of a block stand those of the next that it needs. A
  // block before the record has what earlier noise adds to its first samples.
  MatrixXd rows = MatrixXd::Zero(parameters, kNoiseBlock + order);
  for (Index start = (fit.samples - 1) / kNoiseBlock * kNoiseBlock; start >= -kNoiseBlock;
       start -= kNoiseBlock) {
    const Index length = std::min(kNoiseBlock, fit.samples - start);
    MatrixXd jacobian = MatrixXd::Zero(length, parameters);
    if (start >= 0) jacobian = fit.jacobian_rows(start, length);
    const MatrixXd influence = fit.unit_covariance * jacobian.transpose();
    const ArrayXd leverage =
        influence.cwiseProduct(jacobian.transpose()).colwise().sum().transpose();
    const MatrixXd behind = rows.leftCols(order);
    rows.leftCols(length) = influence;
    rows.middleCols(length, order) = behind;
    for (Index l = length - 1; l >= 0; --l) {
      if (order > 0) rows.col(l).noalias() += rows.middleCols(l + 1, order) * noise.coefficients;
      const Index j = start + l;
      if (j < order) continue;
      const auto before = fit.residual.segment(j - order, order);
      // 0: missing.
      if (fit.residual(j) == 0 || (before.array() == 0).any()) continue;
      const double innovation = fit.residual(j) - noise.coefficients.reverse().dot(before);
      const double square = innovation * innovation / (1 - std::min(leverage(l), 0.99));
      w = rows.col(l).array().square();
      weights += w, squared_weights += w.square(), with_e += square * w;
      ++count, squares += square, fourth_powers += square * square;
    }
    if (order > 0) products += rows.leftCols(length) * rows.leftCols(length).transpose();
  }
  FitUncertainty out;
  out.covariance =
      order > 0 ? (variance * products).eval() : (noise.variance * fit.unit_covariance).eval();
  const double scatter = fourth_powers - squares * squares / std::max(count, 1.0);
  const ArrayXd even = variance * weights;
  const ArrayXd deviation =
      (with_e - even) /
      ((squared_weights - weights.square() / count) * scatter / count).max(1e-300).sqrt();
  out.widening = (deviation > kUneven).select((with_e / even.max(1e-300)).max(1), 1);
  return out;
}

}  // namespace rigfit::signal
