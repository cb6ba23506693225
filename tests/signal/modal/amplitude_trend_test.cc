#include "signal/modal/amplitude_trend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rigfit::signal {
namespace {
using Eigen::Index;

/// Nine points of a sine shape whose frequency falls by `softening` at the strongest, known to 0.01
/// Hz each.
IdentifiedMode mode_at_points(double softening, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  IdentifiedMode mode;
  constexpr Index kPoints = 9;
  mode.participation.resize(kPoints);
  mode.shape = Eigen::VectorXcd::Ones(1);
  mode.frequency_hz = {0, 0.01};
  for (Index i = 0; i < kPoints; ++i) {
    const double size = std::sin(2.3 * static_cast<double>(i + 1) / kPoints);
    mode.participation[i] = {0, size};
    ModeAtPoint point;
    point.order = i;
    point.frequency_hz = {100 - softening * size * size + 0.01 * normal(random), 0.01};
    mode.points.push_back(point);
    mode.frequency_hz.value += point.frequency_hz.value / kPoints;
  }
  return mode;
}

// The line's level at no amplitude is known to some 0.01 Hz here; 0.05 Hz are five times that.
TEST(AmplitudeTrend, TellsTheFrequencyAtSmallAmplitude) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const AmplitudeTrend trend = amplitude_trend(mode_at_points(0.2, seed));
    EXPECT_LT(trend.chance, 0.01);
    EXPECT_NEAR(trend.small_hz, 100, 0.05);
  }
}

// Of 200 modes without it 2 are expected below one in a hundred; 8 or more have a chance of 1e-3.
TEST(AmplitudeTrend, FindsNoneWhereThereIsNone) {
  int found = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    found += amplitude_trend(mode_at_points(0, seed)).chance < 0.01;
  }
  EXPECT_LT(found, 8);
}

}  // namespace
}  // namespace rigfit::signal
