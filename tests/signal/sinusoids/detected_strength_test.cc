#include "signal/sinusoids/detected_strength.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>
#include <gtest/gtest.h>

#include <cmath>

namespace rigfit::signal::detected_strength_test {
namespace {

constexpr double kThreshold = 41;

TEST(DetectedStrength, LosesWhatFourDegreesOfNoiseAdd) {
  // I_2 / I_1 (x) = 1 - 3 / (2 x) - 3 / (8 x^2) - ...: mu = R - 3 / (2 R) - O(6 / R^3).
  for (const double r : {10.0, 20.0, 100.0, 1e5}) {
    EXPECT_NEAR(detected_strength(r * r, 1e-9), r - 1.5 / r, 6 / (r * r * r) + 1e-12 * r) << r;
  }
  // Far above the threshold it does not matter.
  EXPECT_NEAR(detected_strength(400, kThreshold), detected_strength(400, 1e-9), 1e-9);
}

// Densities and chances from tables of the central distributions, maximum on a grid.
TEST(DetectedStrength, IsTheMostLikelyOfThoseThatPass) {
  const auto likelihood = [](double energy, double mu) {
    double density = 0, passes = 0;
    for (unsigned j = 0; j < 150; ++j) {
      const double weight = gsl_ran_poisson_pdf(j, 0.5 * mu * mu);
      density += weight * gsl_ran_chisq_pdf(energy, 4 + 2 * j);
      passes += weight * gsl_cdf_chisq_Q(kThreshold, 4 + 2 * j);
    }
    return density / passes;
  };
  constexpr double kGrid = 0.02;
  for (const double energy : {44.0, 47.0, 55.0, 80.0}) {
    double best = 0, most = 0;
    for (double mu = kGrid; mu < 12; mu += kGrid) {
      const double value = likelihood(energy, mu);
      if (value > most) most = value, best = mu;
    }
    EXPECT_NEAR(detected_strength(energy, kThreshold), best, kGrid) << energy;
  }
}

TEST(DetectedStrength, EndsWhereEverythingMayBeNoise) {
  const double half = 0.5 * kThreshold;
  const double edge = 4 * (1 + 0.5 * half * half / (1 + half));  // of P_6 / P_4 without a mode
  EXPECT_NEAR(edge - kThreshold, 2, 0.2);
  EXPECT_EQ(detected_strength(edge - 1e-6, kThreshold), 0);
  EXPECT_GT(detected_strength(edge + 1e-3, kThreshold), 0);
  EXPECT_LT(detected_strength(edge + 1e-3, kThreshold), 0.2);
  double before = 0;
  for (double energy = kThreshold; energy < 150; ++energy) {
    const double mu = detected_strength(energy, kThreshold);
    EXPECT_GE(mu, before) << energy;
    EXPECT_LT(mu, std::sqrt(energy)) << energy;
    before = mu;
  }
}

}  // namespace
}  // namespace rigfit::signal::detected_strength_test
