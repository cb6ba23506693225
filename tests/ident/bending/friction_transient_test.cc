#include "ident/bending/friction_transient.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "ident/bending/bending_analysis.h"
#include "ident/virtual_rig/virtual_bending.h"

namespace rigfit::ident::friction_transient_test {
namespace {

// Loading and unloading over 1 mm with slope K and a transient of a law after each turn.
std::vector<FrictionStroke> strokes_of(FrictionLaw law, double K, double a, double delta,
                                       double noise, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<FrictionStroke> strokes;
  for (const double sign : {1.0, -1.0}) {
    FrictionStroke stroke;
    stroke.sign = sign;
    const Eigen::Index n = 600;
    stroke.travel_m = Eigen::VectorXd::LinSpaced(n, 0, 1e-3);
    stroke.x_m = sign > 0 ? stroke.travel_m : Eigen::VectorXd(1e-3 - stroke.travel_m.array());
    stroke.load_N.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      stroke.load_N[i] = 0.3 + K * stroke.x_m[i] -
                         sign * a * friction_transient(law, stroke.travel_m[i] / delta) +
                         noise * normal(random);
    }
    strokes.push_back(std::move(stroke));
  }
  return strokes;
}

TEST(FrictionTransient, LawsSolveTheirOwnEquation) {
  // du/dz = -u^i by central differences, h^2 / 6 u''' < 1e-7.
  const std::pair<FrictionLaw, double> laws[] = {{FrictionLaw::exponential, 1},
                                                 {FrictionLaw::hyperbola, 2}};
  for (const auto& [law, exponent] : laws) {
    EXPECT_EQ(friction_transient(law, 0), 1);
    for (const double z : {0.1, 0.5, 0.9}) {
      const double h = 1e-3;
      const double slope =
          (friction_transient(law, z + h) - friction_transient(law, z - h)) / (2 * h);
      EXPECT_NEAR(slope, -std::pow(friction_transient(law, z), exponent), 1e-6);
    }
  }
}

TEST(FrictionTransient, TheRightLawGivesSlopeTravelAndLoadBack) {
  for (const FrictionLaw law : kFrictionLaws) {
    if (law == FrictionLaw::none) continue;
    // The hyperbola's tail is long: half the travel, below the largest that is told from the slope.
    const double travel = law == FrictionLaw::hyperbola ? 5e-5 : 1e-4;
    const auto fit = fit_friction(strokes_of(law, 4000, 0.1, travel, 0, 1), law, 0);
    ASSERT_TRUE(fit.usable);
    // Averaging into bins bends the transient by (bin / delta)^2 / 24 = 7e-5 of its 0.1 N.
    for (const auto& K : fit.stiffness_N_m) EXPECT_NEAR(K.value, 4000, 2);
    EXPECT_NEAR(fit.travel_m, travel, 0.02e-4);
    for (const double a : fit.load_N) EXPECT_NEAR(a, 0.1, 0.002);
  }
}

TEST(FrictionTransient, AStraightLineIsTooSteepAndLosesByItsCriterion) {
  const auto strokes = strokes_of(FrictionLaw::exponential, 4000, 0.1, 1e-4, 0.003, 2);
  const auto straight = fit_friction(strokes, FrictionLaw::none, 0);
  const auto curved = fit_friction(strokes, FrictionLaw::exponential, 0);
  EXPECT_GT(straight.stiffness_N_m[0].value, 4000 * 1.005);
  EXPECT_LT(curved.aicc, straight.aicc - 50);
}

TEST(FrictionTransient, UncertaintyCovers) {
  int covered = 0, total = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const auto fit = fit_friction(strokes_of(FrictionLaw::exponential, 4000, 0.1, 1e-4, 0.01, seed),
                                  FrictionLaw::exponential, 0);
    ASSERT_TRUE(fit.usable);
    for (std::size_t i = 0; i < 2; ++i) {
      const double std = std::hypot(fit.stiffness_N_m[i].std, fit.by_travel[i]);
      covered += std::abs(fit.stiffness_N_m[i].value - 4000) < 1.96 * std;
      ++total;
    }
  }
  // 95 % of 200: 190 +- 3.1; three of these, and pairs of strokes share their delta.
  EXPECT_GE(covered, 178);
}

// A load cell that drifts as a random walk: residuals show little of it, as each line takes most,
// but slopes scatter by sqrt(6/5) of the walk's whole way over the travel, 20 times what white
// noise of the residuals' size would do.
TEST(FrictionTransient, DriftIsInTheUncertainty) {
  constexpr double kWalk = 3e-4;  // N, a sample
  constexpr int kSeeds = 60;
  int covered = 0;
  double share = 0, mean = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    auto strokes = strokes_of(FrictionLaw::exponential, 4000, 0.1, 1e-4, 0.003, seed);
    std::mt19937_64 random(1000 + seed);
    std::normal_distribution<double> normal;
    double walk = 0;
    for (auto& stroke : strokes) {
      for (double& load : stroke.load_N) load += walk += kWalk * normal(random);
    }
    const auto fit = fit_friction(strokes, FrictionLaw::exponential, 0);
    ASSERT_TRUE(fit.usable);
    share += fit.walk_share / kSeeds;
    for (std::size_t i = 0; i < 2; ++i) {
      const double both = std::hypot(fit.stiffness_N_m[i].std, fit.by_travel[i]);
      mean += both / (2 * kSeeds);
      // Student's t for the two strokes' degrees of freedom.
      covered += std::abs(fit.stiffness_N_m[i].value - 4000) < 2.1 * both;
    }
  }
  EXPECT_GT(share, 0.8);
  // sqrt(6/5 * 600) * 3e-4 N over 1 mm is 8 N/m; the transient takes some of the line's hold.
  EXPECT_GT(mean, 7);
  EXPECT_LT(mean, 14);
  EXPECT_GE(covered, 107);  // of 120: 95 %, three binomial deviations
}

TEST(FrictionTransient, AToeIsNoFriction) {
  auto strokes = strokes_of(FrictionLaw::none, 4000, 0, 1e-4, 0, 3);
  for (auto& stroke : strokes) {  // softer at the beginning
    for (Eigen::Index i = 0; i < stroke.load_N.size(); ++i) {
      stroke.load_N[i] += stroke.sign * 0.05 * std::exp(-stroke.travel_m[i] / 1e-4);
    }
  }
  const auto fit = fit_friction(strokes, FrictionLaw::exponential, 0);
  ASSERT_TRUE(fit.usable);
  for (const double a : fit.load_N) EXPECT_EQ(a, 0);
}

TEST(FrictionTransient, TooFewSamplesAreNotUsed) {
  FrictionStroke stroke;
  stroke.travel_m = stroke.x_m = stroke.load_N = Eigen::VectorXd::LinSpaced(5, 0, 1);
  EXPECT_FALSE(fit_friction({stroke}, FrictionLaw::exponential, 0).usable);
  EXPECT_FALSE(fit_friction({}, FrictionLaw::exponential, 0).usable);
}

// Virtual bending tests whose friction takes a fifth of the stroke to turn round. A straight line
// is 3 to 5 % too stiff there; the long study is tests/bench/bending_coverage.
TEST(BendingTest, FrictionIsInTheEstimateAndInItsInterval) {
  int covered = 0, trials = 0;
  double relative = 0;
  for (const double exponent : {1.0, 1.5}) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      VirtualBendingTest test;
      test.EI_Nm2 = 0.8;
      test.tension_N = 300;
      test.span_m = 0.5;
      test.peak_load_N = 4;
      test.friction_load_N = 0.08;
      test.friction_travel_m = exponent == 1 ? 2e-4 : 1e-4;
      test.friction_exponent = exponent;
      test.load_cell.noise_std = 0.005;
      test.lvdt.noise_std = 2e-6;
      test.tension_cell.noise_std = 0.05;
      Random random = random_stream(seed, 3);
      const auto record = virtual_bending_record(test, random);
      BendingTestOptions options;
      options.span_m = {0.5, 0};
      const auto result =
          analyse_bending_test({record.channel("tension").samples, record.channel("load").samples,
                                record.channel("deflection").samples},
                               options);
      ASSERT_FALSE(result.refused);
      EXPECT_GT(result.friction_probability, 0.99);
      EXPECT_LT(result.relative_friction_correction, 0);
      covered += result.stiffness.low <= 0.8 && 0.8 <= result.stiffness.high;
      relative += result.stiffness.EI_Nm2.value / 0.8 - 1;
      ++trials;
    }
  }
  EXPECT_GE(covered, 34) << trials;  // 95 % of 40: 38 +- 1.4, three of these
  EXPECT_LT(std::abs(relative / trials), 0.005);
}

}  // namespace
}  // namespace rigfit::ident::friction_transient_test
