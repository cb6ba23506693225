#include "signal/variation/amplitude_trend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "signal/modal/modal_identification.h"
#include "tests/reference/defective_frfs.h"

namespace rigfit::signal::amplitude_trend_test {
namespace {

/// A mode at 100 Hz hit `hits` times on each of `points` points, its frequency off by `offset` at
/// each, falling by `softening` for amplitude 1, known to 0.01 Hz by itself.
std::vector<ValueOfHit> mode_of_hits(std::size_t points, int hits, double softening, double offset,
                                     unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.5, 1.0);
  std::vector<ValueOfHit> fits;
  for (std::size_t point = 0; point < points; ++point) {
    const double place = hits > 1 ? 1 : std::sin(0.26 * static_cast<double>(point + 1));
    const double here = offset * normal(random);
    for (int hit = 0; hit < hits; ++hit) {
      const double a = uniform(random) * place;
      const double f = 100 + here - softening * a * a + 0.01 * normal(random);
      fits.push_back({point, a, {f, 0.01}});
    }
  }
  return fits;
}

struct Held {
  int certain = 0, held = 0;
};

/// Of 200 seeds.
Held study(std::size_t points, int hits, double softening, double offset) {
  Held held;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const auto trend = amplitude_trend(mode_of_hits(points, hits, softening, offset, seed));
    if (!trend) continue;
    held.certain += trend->chance < 0.01;
    held.held += std::abs(trend->small.value - 100) < 1.96 * trend->small.std;
  }
  return held;
}

// 95 % of 200 are 190 +- 3.1: fewer than 180 in one of a thousand. Student's t with one value of
// the scatter for each hit, as here, holds exactly; noise taken as the least scatter makes it hold
// more.
TEST(AmplitudeTrend, TellsTheFrequencyAtSmallAmplitude) {
  for (const auto& held : {study(9, 1, 0.2, 0), study(1, 8, 0.2, 0), study(3, 4, 0.2, 0.05)}) {
    EXPECT_GE(held.held, 180);
    EXPECT_GE(held.certain, 150);
  }
}

// Of 200 without a trend 2 are expected below one in a hundred; 8 or more have a chance of 1e-3.
TEST(AmplitudeTrend, FindsNoneWhereThereIsNone) {
  for (const auto& held : {study(9, 1, 0, 0), study(1, 8, 0, 0), study(3, 4, 0, 0.05)}) {
    EXPECT_LT(held.certain, 8);
    EXPECT_GE(held.held, 180);
  }
}

TEST(AmplitudeTrend, NeedsHitsOfDifferentSize) {
  std::vector<ValueOfHit> fits;
  for (int hit = 0; hit < 6; ++hit) fits.push_back({0, 1, {100 + 0.01 * hit, 0.01}});
  EXPECT_FALSE(amplitude_trend(fits));
  EXPECT_FALSE(amplitude_trend(mode_of_hits(1, 2, 0.2, 0, 1)));
  EXPECT_FALSE(amplitude_trend(mode_of_hits(4, 1, 0.2, 0, 1)));
  EXPECT_FALSE(amplitude_trend({}));
}

// A cubic spring, eight points struck once with hits of 30 % scatter: frequencies of the linear
// rig. Of 9 values one in a hundred such sets has an error beyond 3.3 standard deviations.
TEST(AmplitudeTrend, ACubicSpringGivesTheFrequencyOfTheLinearRig) {
  testing::DefectiveFrfOptions options;
  options.damping_ratio = 0.005;
  options.spacing_hz = 0.5;
  options.low_hz = 20;
  options.high_hz = 400;
  options.softening = 0.3;
  for (options.seed = 1; options.seed <= 3; ++options.seed) {
    const ModalResult result = identify_modes(testing::defective_frfs(options));
    ASSERT_EQ(result.model.modes.size(), 3u);
    std::vector<std::string> codes;
    for (const Note& note : result.model.notes) codes.push_back(note.code);
    EXPECT_THAT(codes, ::testing::Contains("frequency_depends_on_amplitude"));
    for (std::size_t r = 0; r < 3; ++r) {
      const IdentifiedMode& mode = result.model.modes[r];
      const double f = options.frequency_hz[static_cast<Eigen::Index>(r)];
      EXPECT_TRUE(mode.amplitude.found);
      EXPECT_LT(mode.amplitude.slope.value, 0);
      EXPECT_LT(std::abs(mode.frequency_hz.value - f), 3.3 * mode.frequency_hz.std);
      // Less than the shift at the strongest point, a third of the bandwidth 2 zeta f.
      EXPECT_LT(mode.frequency_hz.std, 0.3 * 2 * options.damping_ratio * f);
      EXPECT_LT(mode.amplitude.frequency_of_test_hz, mode.frequency_hz.value);
    }
  }
  options.hit_sizes = false;
  const ModalResult unknown = identify_modes(testing::defective_frfs(options));
  for (const IdentifiedMode& mode : unknown.model.modes) EXPECT_FALSE(mode.amplitude.found);
}

}  // namespace
}  // namespace rigfit::signal::amplitude_trend_test
