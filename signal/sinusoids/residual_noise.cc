#include "signal/sinusoids/residual_noise.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace rigfit::signal {

using Eigen::Index;

double ResidualNoise::white_equivalent(double frequency) const {
  std::complex<double> a = 1;
  for (Index k = 0; k < coefficients.size(); ++k) {
    a -= coefficients(k) *
         std::polar(1.0, -2 * std::numbers::pi * frequency * static_cast<double>(k + 1));
  }
  return innovation_variance / std::norm(a);
}

namespace {

/// Levinson and Durbin's recursion, one order a step.
class Autoregression {
 public:
  Autoregression(const Eigen::Ref<const Eigen::VectorXd>& x, Index highest)
      : covariance_(highest + 1), a_(Eigen::VectorXd::Zero(highest)), before_(a_) {
    for (Index k = 0; k <= highest; ++k) {
      covariance_(k) = x.head(x.size() - k).dot(x.tail(x.size() - k));
    }
    error_ = covariance_(0);
  }
  /// To the next order; false when rounding allows none.
  bool step() {
    const Index p = ++order_;
    double reflection = covariance_(p);
    for (Index k = 1; k < p; ++k) reflection -= before_(k - 1) * covariance_(p - k);
    reflection /= error_;
    if (!(std::abs(reflection) < 1)) return false;
    a_ = before_;
    a_(p - 1) = reflection;
    for (Index k = 1; k < p; ++k) a_(k - 1) = before_(k - 1) - reflection * before_(p - k - 1);
    error_ *= 1 - reflection * reflection;
    before_ = a_;
    return true;
  }
  [[nodiscard]] double error() const { return error_; }
  [[nodiscard]] auto coefficients() const { return a_.head(order_); }

 private:
  Eigen::VectorXd covariance_, a_, before_;
  double error_ = 0;
  Index order_ = 0;
};

}  // namespace

double prediction_error(const Eigen::Ref<const Eigen::VectorXd>& x, Index order) {
  Autoregression model(x, std::min(order, x.size() - 1));
  for (Index p = 1; p <= std::min(order, x.size() - 1); ++p) {
    if (!(model.error() > 0) || !model.step()) break;
  }
  return model.error();
}

ResidualNoise residual_noise(const Eigen::Ref<const Eigen::VectorXd>& residual, Index degrees) {
  ResidualNoise noise;
  const double sum = residual.squaredNorm();
  noise.variance = noise.innovation_variance =
      sum / static_cast<double>(std::max<Index>(degrees, 1));
  // The fit itself takes a notch out of the spectrum; an order that could follow it is not allowed.
  const Index highest = std::min<Index>(24, degrees / 25);
  if (highest < 1 || !(sum > 0)) return noise;
  Autoregression model(residual, highest);
  const double count = static_cast<double>(degrees), penalty = std::log(count);
  Eigen::VectorXd best;
  double best_score = count * std::log(sum), best_error = sum;
  for (Index p = 1; p <= highest && model.step(); ++p) {
    const double score = count * std::log(model.error()) + penalty * static_cast<double>(p);
    if (score < best_score) {
      best_score = score, best_error = model.error(), best = model.coefficients();
    }
  }
  noise.coefficients = best;
  noise.innovation_variance *= best_error / sum;
  return noise;
}

namespace {

// Samples that are gone through at a time.
constexpr Index kNoiseBlock = 256;
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

double FitUncertainty::widening(Index k) const {
  return deviation(k) > kUneven ? std::max(1.0, variance_ratio(k)) : 1;
}

Eigen::MatrixXd FitUncertainty::widened() const {
  Eigen::VectorXd factor(covariance.rows());
  for (Index k = 0; k < factor.size(); ++k) factor(k) = std::sqrt(widening(k));
  return factor.asDiagonal() * covariance * factor.asDiagonal();
}

FitUncertainty fit_uncertainty(const DampedSinusoidsFit& fit, const ResidualNoise& noise) {
  const Index order = noise.coefficients.size(), parameters = fit.unit_covariance.rows();
  const double variance = noise.innovation_variance;
  const Innovations e = innovations(fit.residual, noise.coefficients);
  Eigen::ArrayXd w = Eigen::ArrayXd::Zero(parameters), weights = w, squared_weights = w, with_e = w;
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(parameters, parameters);
  double count = 0, squares = 0, fourth_powers = 0;
  // Filtered from the end on: behind the rows of a block stand those of the next that it needs. A
  // block before the record has what earlier noise adds to its first samples.
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(parameters, kNoiseBlock + order);
  for (Index start = (fit.samples - 1) / kNoiseBlock * kNoiseBlock; start >= -kNoiseBlock;
       start -= kNoiseBlock) {
    const Index length = std::min(kNoiseBlock, fit.samples - start);
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(length, parameters);
    if (start >= 0) jacobian = fit.jacobian_rows(start, length);
    const Eigen::MatrixXd influence = fit.unit_covariance * jacobian.transpose();
    const Eigen::ArrayXd leverage =
        influence.cwiseProduct(jacobian.transpose()).colwise().sum().transpose();
    const Eigen::MatrixXd behind = rows.leftCols(order);
    rows.leftCols(length) = influence;
    rows.middleCols(length, order) = behind;
    for (Index l = length - 1; l >= 0; --l) {
      if (order > 0) rows.col(l).noalias() += rows.middleCols(l + 1, order) * noise.coefficients;
      const Index j = start + l;
      if (j < 0 || !e.known[static_cast<std::size_t>(j)]) continue;
      const double square = e.values(j) * e.values(j) / (1 - std::min(leverage(l), 0.99));
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
  out.variance_ratio = with_e / (variance * weights).max(1e-300);
  out.deviation =
      (with_e - variance * weights) /
      ((squared_weights - weights.square() / count) * scatter / count).max(1e-300).sqrt();
  return out;
}

}  // namespace rigfit::signal
