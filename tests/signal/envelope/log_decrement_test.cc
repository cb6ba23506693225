#include "signal/envelope/log_decrement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace rigfit::signal::log_decrement_test {
namespace {

Eigen::VectorXd decay(double f, double zeta, double rate, double duration, double offset = 0) {
  const double w = 2 * std::numbers::pi * f, wd = w * std::sqrt(1 - zeta * zeta);
  Eigen::VectorXd y(static_cast<Eigen::Index>(std::lround(duration * rate)));
  for (Eigen::Index j = 0; j < y.size(); ++j) {
    const double t = static_cast<double>(j) / rate;
    y(j) = offset + std::exp(-zeta * w * t) * std::cos(wd * t + 0.7);
  }
  return y;
}

TEST(LogDecrement, FindsDampingBetweenTenSamplesACycleAndAThousand) {
  for (const double rate : {150.0, 500.0, 1234.0, 50000.0}) {
    for (const double zeta : {0.001, 0.017, 0.1}) {
      const auto result = log_decrement(decay(50, zeta, rate, 0.6, 3.0), rate, 50);
      ASSERT_TRUE(result.refusal.empty()) << result.refusal;
      // A parabola through an extreme in steps of 1/8 sample, 3 samples a cycle: (pi/12)^4/24 =
      // 2e-4 of the swing at most, of either sign from peak to peak, against swings over dozens of
      // cycles.
      EXPECT_NEAR(result.damping_ratio.value, zeta, 2e-3 * zeta + 2e-5) << rate << " " << zeta;
      const double damped = 50 * std::sqrt(1 - zeta * zeta);
      EXPECT_NEAR(result.frequency_hz.value, damped, 1e-3 * damped);
      EXPECT_GT(result.r_squared, 0.99);
    }
  }
}

TEST(LogDecrement, UncertaintyCoversUnderNoise) {
  // Peaks are found where noise is highest, so the swing is a little too large late in the decay;
  // at 40 dB that bias is small beside the scatter. 200 seeds: 95 % +- 1.5 % (one sigma); the
  // estimate of the standard deviation itself has some 40 degrees of freedom.
  int inside = 0;
  const auto clean = decay(50, 0.017, 500, 1);
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> noise(0, std::sqrt(0.5e-4));
    Eigen::VectorXd y = clean;
    for (double& v : y) v += noise(generator);
    LogDecrementOptions options;
    options.noise_std = std::sqrt(0.5e-4);
    const auto result = log_decrement(y, 500, 50, options);
    ASSERT_TRUE(result.refusal.empty());
    inside += std::abs(result.damping_ratio.value - 0.017) < 2 * result.damping_ratio.std;
  }
  EXPECT_GE(inside, 176);  // 88 %
}

TEST(LogDecrement, RefusesWhatItCannotSee) {
  EXPECT_FALSE(log_decrement(decay(50, 0.01, 110, 2), 110, 50).refusal.empty());
  EXPECT_FALSE(log_decrement(decay(50, 0.01, 500, 0.02), 500, 50).refusal.empty());
  LogDecrementOptions loud;
  loud.noise_std = 10;
  EXPECT_FALSE(log_decrement(decay(50, 0.01, 500, 1), 500, 50, loud).refusal.empty());
  EXPECT_THROW((void)log_decrement(decay(50, 0.01, 500, 1), 500, 0), std::invalid_argument);
}

}  // namespace
}  // namespace rigfit::signal::log_decrement_test
