#include "signal/sinusoids/residual_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace rigfit::signal::residual_noise_test {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

Eigen::VectorXd coloured(Index n, double colour, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd y(n);
  double last = normal(generator) / std::sqrt(1 - colour * colour);
  for (double& v : y) v = last = colour * last + normal(generator);
  return y;
}

TEST(ResidualNoise, TellsWhiteFromColouredAndItsDensity) {
  const auto white = residual_noise(coloured(20000, 0, 1), 20000);
  EXPECT_LE(white.coefficients.size(), 1);
  EXPECT_NEAR(white.variance, 1, 0.04);  // four times sqrt(2/n)
  const auto red = residual_noise(coloured(20000, 0.8, 2), 20000);
  ASSERT_GE(red.coefficients.size(), 1);
  EXPECT_NEAR(red.coefficients(0), 0.8, 0.03);
  EXPECT_NEAR(red.innovation_variance, 1, 0.05);
  // S(0) = 1 / (1 - 0.8)^2 = 25: d ln S / da = 10, and a is known to 0.0042.
  EXPECT_NEAR(red.white_equivalent(0), 25, 25 * 0.17);
}

TEST(ResidualNoise, CovarianceOfACrowdOfFitsUnderColouredNoiseIsAsStated) {
  // 400 records of the same decay under AR(0.9) noise: scatter against the stated standard
  // uncertainty, both to sqrt(1/800) = 3.5 %, four times that allowed, plus the model order's
  // choice.
  const Complex pole(-0.01, 0.3);
  double squared = 0, stated = 0;
  for (unsigned seed = 0; seed < 400; ++seed) {
    Eigen::VectorXd y = 0.05 * coloured(400, 0.9, seed + 10);
    for (Index j = 0; j < y.size(); ++j) y(j) += std::exp(pole * static_cast<double>(j)).real();
    const auto fit = fit_damped_sinusoids(y, std::span(&pole, 1));
    const auto covariance =
        fit_uncertainty(fit, residual_noise(fit.residual, fit.degrees)).covariance;
    squared += std::norm(fit.poles[0] - pole);
    stated += covariance(2, 2) + covariance(3, 3);
  }
  EXPECT_NEAR(squared / stated, 1, 0.3);
}

}  // namespace
}  // namespace rigfit::signal::residual_noise_test
