#include "signal/profile_interval.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

namespace rigfit::signal::profile_interval_test {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

Eigen::VectorXd noisy(Complex pole, Index n, double noise, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd y(n);
  for (Index j = 0; j < n; ++j) {
    y(j) = std::exp(pole * static_cast<double>(j)).real() + noise * normal(generator);
  }
  return y;
}

TEST(ProfileInterval, IsValueAndStdWhereTheFitIsLinear) {
  const Complex pole(-0.01, 0.6);
  const auto y = noisy(pole, 500, 1e-4, 3);
  const auto fit = fit_damped_sinusoids(y, std::span(&pole, 1));
  const double s = std::sqrt(fit.residual_sum_squares / static_cast<double>(fit.degrees));
  for (const Index part : {0, 1}) {
    const double std = s * std::sqrt(fit.unit_covariance(2 + part, 2 + part));
    const auto interval = profile_interval(y, {}, fit, part, std, 1.96);
    // Curvature over k std: some 2 std / 0.01 = 1e-3; the search ends within 1e-3.
    EXPECT_NEAR(interval.below, 1, 4e-3);
    EXPECT_NEAR(interval.above, 1, 4e-3);
    EXPECT_TRUE(interval.bounded);
  }
}

TEST(ProfileInterval, EndsWhereTheSumOfSquaresHasRisenByTheFactor) {
  // Against the definition, on the best fits over a grid of held decay rates, in heavy noise.
  const Complex pole(-0.01, 0.6);
  const auto y = noisy(pole, 500, 0.3, 5);
  const auto fit = fit_damped_sinusoids(y, std::span(&pole, 1));
  const double s2 = fit.residual_sum_squares / static_cast<double>(fit.degrees);
  const double std = std::sqrt(s2 * fit.unit_covariance(2, 2));
  const auto interval = profile_interval(y, {}, fit, 0, std, 1.96);
  ASSERT_TRUE(interval.bounded);
  EXPECT_GT(interval.below, interval.above);  // more damping is less well excluded
  for (const double end : {-interval.below, interval.above}) {
    const double held = fit.poles[0].real() + end * 1.96 * std;
    double least = 1e300;
    for (double w = fit.poles[0].imag() - 0.01; w < fit.poles[0].imag() + 0.01; w += 2e-5) {
      DampedSinusoidsOptions at;
      at.max_iterations = 0;
      const Complex trial(held, w);
      least =
          std::min(least, fit_damped_sinusoids(y, std::span(&trial, 1), at).residual_sum_squares);
    }
    // The root of the rise is met within 1e-3, the grid's minimum within curvature of 1e-5 rad.
    EXPECT_NEAR(std::sqrt((least - fit.residual_sum_squares) / s2), 1.96, 0.01);
  }
}

TEST(ProfileInterval, SaysWhenASideIsNotBounded) {
  // Two cycles in noise four times the signal: any damping will do.
  const Complex pole(-0.001, 0.2);
  const auto y = noisy(pole, 64, 4.0, 2);
  const auto fit = fit_damped_sinusoids(y, std::span(&pole, 1));
  const double s = std::sqrt(fit.residual_sum_squares / static_cast<double>(fit.degrees));
  const auto interval =
      profile_interval(y, {}, fit, 0, s * std::sqrt(fit.unit_covariance(2, 2)), 3.0);
  EXPECT_FALSE(interval.bounded);
  EXPECT_LE(std::max(interval.below, interval.above), 4.0);
}

}  // namespace
}  // namespace rigfit::signal::profile_interval_test
