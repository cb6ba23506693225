#include "signal/detected_interval.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rigfit::signal::detected_interval_test {
namespace {

constexpr double kFactor = 1.96, kThreshold = 41;

TEST(DetectedInterval, IsThePlainOneWithoutAThresholdAndFarAboveIt) {
  // P = 1: l = r^2 / 2. Bisection of 50 steps: rounding.
  for (const double energy : {5.0, 36.0, 46.0}) {
    EXPECT_NEAR(factor_of_detected(energy, 1e-9, kFactor), kFactor, 1e-9) << energy;
  }
  EXPECT_EQ(factor_of_detected(400, kThreshold, kFactor), kFactor);
  // Where the short cut is taken nothing jumps.
  const double edge = std::pow(std::sqrt(kThreshold) + kFactor + 5, 2);
  EXPECT_NEAR(factor_of_detected(edge * (1 - 1e-9), kThreshold, kFactor), kFactor, 1e-5);
}

TEST(DetectedInterval, GrowsTowardTheThresholdAndEndsWithTheMode) {
  double before = kFactor;
  for (double energy = 150; energy >= kThreshold; energy -= 1) {
    const double factor = factor_of_detected(energy, kThreshold, kFactor);
    EXPECT_GE(factor, before * (1 - 1e-9)) << energy;
    EXPECT_LE(factor, std::sqrt(energy) * (1 + 1e-9)) << energy;
    before = factor;
  }
  EXPECT_GT(before, 1.3 * kFactor);
}

// A direction in four dimensions: y = mu u + noise, seen where |y|^2 > T. Of its latitude phi the
// profile is r(phi) = |y| cos(phi - estimate), so that the interval is |y| |sin(phi - estimate)| <=
// k', and on the equator it holds the truth where the fourth component is within k'.
TEST(DetectedInterval, HoldsTheTruthOfThoseThatPass) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  constexpr int kTrials = 3000;
  int plain_missed = 0, seen = 0;
  for (const double mu : {4.5, 5.5, 6.5, 8.0}) {
    int covered = 0;
    for (int trial = 0; trial < kTrials;) {
      double y[4] = {mu + normal(random), normal(random), normal(random), normal(random)};
      const double energy = y[0] * y[0] + y[1] * y[1] + y[2] * y[2] + y[3] * y[3];
      if (energy <= kThreshold) continue;
      ++trial, ++seen;
      covered += std::abs(y[3]) <= factor_of_detected(energy, kThreshold, kFactor);
      plain_missed += std::abs(y[3]) > kFactor;
    }
    // Three binomial deviations of 3000 at 95 %: 1.2 %. The likelihood's quadratic form is not
    // exact so near the threshold: from above too, 99 % at most.
    EXPECT_GT(covered, (0.95 - 0.012) * kTrials) << mu;
    EXPECT_LT(covered, 0.99 * kTrials) << mu;
  }
  EXPECT_GT(plain_missed, 0.06 * seen);
}

}  // namespace
}  // namespace rigfit::signal::detected_interval_test
