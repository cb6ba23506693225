#include "signal/residual_noise.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "signal/fft.h"

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

ResidualNoise residual_noise(const Eigen::Ref<const Eigen::VectorXd>& residual, Index degrees) {
  const Index n = residual.size();
  ResidualNoise noise;
  const double sum = residual.squaredNorm();
  noise.variance = noise.innovation_variance =
      sum / static_cast<double>(std::max<Index>(degrees, 1));
  // The fit itself takes a notch out of the spectrum; an order that could follow it is not allowed.
  const Index highest = std::min<Index>(24, degrees / 25);
  if (highest < 1 || !(sum > 0)) return noise;
  Eigen::VectorXd covariance(highest + 1);
  for (Index k = 0; k <= highest; ++k) {
    covariance(k) = residual.head(n - k).dot(residual.tail(n - k));
  }
  Eigen::VectorXd a = Eigen::VectorXd::Zero(highest), previous = a, best;
  double error = covariance(0);
  const double count = static_cast<double>(degrees), penalty = std::log(count);
  double best_score = count * std::log(error), best_error = error;
  for (Index p = 1; p <= highest; ++p) {
    double reflection = covariance(p);
    for (Index k = 1; k < p; ++k) reflection -= previous(k - 1) * covariance(p - k);
    reflection /= error;
    if (!(std::abs(reflection) < 1)) break;
    a = previous;
    a(p - 1) = reflection;
    for (Index k = 1; k < p; ++k) a(k - 1) = previous(k - 1) - reflection * previous(p - k - 1);
    error *= 1 - reflection * reflection;
    const double score = count * std::log(error) + penalty * static_cast<double>(p);
    if (score < best_score) best_score = score, best_error = error, best = a.head(p);
    previous = a;
  }
  noise.coefficients = best;
  noise.innovation_variance *= best_error / covariance(0);
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
