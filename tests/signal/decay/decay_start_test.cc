#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "signal/decay/decay.h"
#include "signal/decay/decay_window.h"

namespace rigfit::signal::decay_start_test {
namespace {

using Eigen::Index;

constexpr Index kSamples = 3000;
constexpr double kCycle = 50;  // samples of the strongest mode

/// Three modes, and what is left of a blow for the first `tail` samples: no exponential.
Eigen::VectorXd record(double tail, double noise, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd y(kSamples);
  for (Index j = 0; j < kSamples; ++j) {
    const double t = static_cast<double>(j), turn = 2 * std::numbers::pi * t / kCycle;
    y(j) = std::exp(-t / 900) * std::cos(turn) + 0.3 * std::exp(-t / 700) * std::cos(2.7 * turn) +
           0.2 * std::exp(-t / 500) * std::cos(4.4 * turn + 1) + noise * normal(random);
    if (tail > 0)
      y(j) += 2 * std::exp(-t * t / (tail * tail)) * std::cos(3.6 * turn + 0.003 * t * t);
  }
  return y;
}

TEST(DecayStart, StaysWhereNothingIsLeftOfTheBlow) {
  DecayOptions given;
  given.choose_window = false;
  EXPECT_EQ(estimate_decay(record(0, 0.01, 1), 1000, given).start, 0);
}

// What is left of the blow bends the answers by many standard uncertainties; the start moves behind
// it, by no more than three cycles.
TEST(DecayStart, MovesBehindWhatIsLeftOfTheBlow) {
  DecayOptions given;
  given.choose_window = false;
  int moved = 0;
  for (const double tail : {20.0, 40.0, 70.0}) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const auto result = estimate_decay(record(tail, 0.01, seed), 1000, given);
      ASSERT_FALSE(result.modes.empty()) << result.refusal;
      EXPECT_LE(result.start, 3 * kCycle);
      if (result.start == 0) continue;
      ++moved;
      const auto& mode = result.modes.front();
      EXPECT_NEAR(mode.damped_frequency_hz.value, 1000 / kCycle, 5 * mode.damped_frequency_hz.std)
          << tail << " " << seed;
    }
  }
  EXPECT_GE(moved, 3);
}

// A swing that comes to rest on a coarse scale is no logger that stopped; a cut is one.
TEST(RecordedUntil, RestOnAnIntegerScaleIsNoStop) {
  Eigen::VectorXd y(400);
  for (Eigen::Index k = 0; k < y.size(); ++k) {
    const double t = static_cast<double>(k);
    y[k] = std::round(20 * std::exp(-0.025 * t) * std::cos(0.7 * t));
  }
  EXPECT_EQ(recorded_until(y), 400);
  y.tail(340).setZero();
  EXPECT_EQ(recorded_until(y), 60);
}

}  // namespace
}  // namespace rigfit::signal::decay_start_test
