#include "signal/modal/mode_hits.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "signal/impact/impact_frfs.h"
#include "signal/modal/modal_identification.h"
#include "tests/reference/struck_structure.h"

namespace rigfit::signal {
namespace {
using Eigen::Index;

/// Largest error of frequency and damping over their standard deviations, sure modes of four seeds.
double worst_error(const testing::StrikeOptions& strike, int& sure,
                   std::optional<double> window_s = {}) {
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    testing::StrikeOptions with = strike;
    with.seed = seed;
    const testing::StruckStructure structure(2);
    const auto recordings = struck_recordings(structure, with);
    ImpactTestOptions impact;
    impact.hits.band_hz = {3, 70};
    impact.force_window_s = window_s;
    const std::vector<std::string> names{"a1", "a2"};
    ModalOptions modal;
    modal.low_hz = 3, modal.high_hz = 70;
    const auto result =
        identify_modes(analyse_impact_test(recordings, "force", names, impact).frfs, modal);
    for (const IdentifiedMode& mode : result.model.modes) {
      if (mode.doubtful) continue;
      Index r = 0;
      (structure.frequency_hz.array() - mode.frequency_hz.value).abs().minCoeff(&r);
      const auto [f, f_std] = mode.frequency_hz;
      const auto [zeta, zeta_std] = mode.damping_ratio;
      worst = std::max({worst, std::abs(f - structure.frequency_hz[r]) / f_std,
                        std::abs(zeta - structure.damping_ratio[r]) / zeta_std});
      ++sure;
    }
  }
  return worst;
}

// 32 values each: one of a hundred such sets has an error of 3.6 standard deviations.
TEST(ModeHits, ErrorBarsCoverWhatAForceWindowLeavesOfTheForcesNoise) {
  testing::StrikeOptions strike;
  strike.force_noise = 0.02;
  int sure = 0;
  EXPECT_LT(worst_error(strike, sure), 3.6);
  EXPECT_GE(sure, 12);
}

// The noise left correlates over 10 Hz; an invented mode is many standard deviations from any.
TEST(ModeHits, ErrorBarsCoverWhatALongForceWindowLeaves) {
  testing::StrikeOptions strike;
  strike.force_noise = 0.02;
  int sure = 0;
  EXPECT_LT(worst_error(strike, sure, 0.1), 3.6);
  EXPECT_GE(sure, 12);
}

// The resonance of the average is wider than that of a hit; two poles that it seems to hold are
// one.
TEST(ModeHits, ErrorBarsCoverAFrequencyThatChangesByAThirdOfABandwidth) {
  testing::StrikeOptions strike;
  strike.frequency_scatter = 3e-3;
  int sure = 0;
  EXPECT_LT(worst_error(strike, sure), 3.6);
  EXPECT_GE(sure, 12);
}

TEST(ModeHits, ErrorBarsCoverAFrequencyThatChangesFromHitToHit) {
  testing::StrikeOptions strike;
  strike.frequency_scatter = 1e-4;
  int sure = 0;
  EXPECT_LT(worst_error(strike, sure), 3.6);
  EXPECT_GE(sure, 12);
}

}  // namespace
}  // namespace rigfit::signal
