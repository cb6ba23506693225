#include "signal/sinusoids/residual_noise.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "signal/spectra/fft.h"

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

Eigen::MatrixXd fit_covariance(const DampedSinusoidsFit& fit, const ResidualNoise& noise) {
  if (fit.unit_covariance.size() == 0) return {};
  if (noise.coefficients.size() == 0) return noise.variance * fit.unit_covariance;
  const Index parameters = fit.unit_covariance.rows(), n = fit.samples;
  RealFft fft(good_fft_length(2 * n));
  const Index lines = fft.lines();
  Eigen::VectorXd weight(lines);  // density per line, both halves of the spectrum
  for (Index k = 0; k < lines; ++k) {
    const bool single = k == 0 || 2 * k == fft.length();
    weight(k) = std::sqrt(
        (single ? 1.0 : 2.0) / static_cast<double>(fft.length()) *
        noise.white_equivalent(static_cast<double>(k) / static_cast<double>(fft.length())));
  }
  Eigen::MatrixXcd columns(lines, parameters);
  for (Index k = 0; k < parameters; ++k) {
    auto time = fft.time();
    time.head(n) = fit.jacobian_column(k);
    time.tail(time.size() - n).setZero();
    fft.forward();
    columns.col(k) = fft.spectrum().cwiseProduct(weight.cast<std::complex<double>>());
  }
  const Eigen::MatrixXd middle = (columns.adjoint() * columns).real();
  return fit.unit_covariance * middle * fit.unit_covariance;
}

}  // namespace rigfit::signal
