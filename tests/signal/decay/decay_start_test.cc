#include "signal/decay/decay_start.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

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

struct Searched {
  DampedSinusoidsFit fit;
  bool may_stay = false;  // by the rule of the header, written anew
};

Searched searched(const Eigen::VectorXd& y, Index start) {
  Searched result;
  const DecayBand band{0, 0.5, true};
  result.fit = *find_decay_modes(decay_samples(y, start, y.size()), band, {});
  const double cycle =
      2 * std::numbers::pi / result.fit.poles[strongest_mode(result.fit, band)].imag();
  const auto half = static_cast<Index>(std::lround(0.5 * cycle));
  const auto rest = result.fit.samples - static_cast<Index>(std::ceil(2 * cycle));
  const double level = result.fit.residual.tail(rest).squaredNorm() / static_cast<double>(rest);
  result.may_stay =
      result.fit.residual.head(half).squaredNorm() <= 9 * level * static_cast<double>(half);
  return result;
}

TEST(DecayStart, StaysWhereNothingIsLeftOfTheBlow) {
  const Eigen::VectorXd y = record(0, 0.01, 1);
  const DecayBand band{0, 0.5, true};
  const auto whole = searched(y, 0);
  ASSERT_TRUE(whole.may_stay);
  EXPECT_FALSE(later_start(y, 0, y.size(), whole.fit, band, {}));
}

// The start is one that will do and half a cycle earlier will not, and the fit is the search's.
TEST(DecayStart, IsTheFirstThatWillDo) {
  const DecayBand band{0, 0.5, true};
  int moved = 0;
  for (const double tail : {20.0, 40.0, 70.0}) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const Eigen::VectorXd y = record(tail, 0.01, seed);
      const auto whole = searched(y, 0);
      if (whole.may_stay) continue;
      const auto later = later_start(y, 0, y.size(), whole.fit, band, {});
      ASSERT_TRUE(later);
      const auto at = searched(y, later->start);
      EXPECT_EQ(later->fit.residual_sum_squares, at.fit.residual_sum_squares);
      EXPECT_EQ(later->samples.values.size(), y.size() - later->start);
      // 0.35 time constants are 12 half cycles: none of these tails is as long.
      EXPECT_TRUE(at.may_stay) << tail << " " << seed;
      const Index half = static_cast<Index>(kCycle / 2);
      if (later->start <= half) continue;
      ++moved;
      EXPECT_FALSE(searched(y, later->start - half).may_stay) << tail << " " << seed;
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
