// Resonances that are not linear, from FRFs alone.
#include "signal/variation/resonance_distortion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "signal/impact/impact_test.h"
#include "signal/modal/modal_identification.h"
#include "signal/modes/modal_band.h"
#include "tests/reference/defective_frfs.h"
#include "tests/reference/struck_structure.h"

namespace rigfit::signal {
namespace {

testing::DefectiveFrfOptions plate(std::uint64_t seed) {
  testing::DefectiveFrfOptions options;
  options.damping_ratio = 0.005;
  options.spacing_hz = 0.5;
  options.low_hz = 20;
  options.high_hz = 400;
  options.hit_sizes = false;
  options.seed = seed;
  return options;
}

bool noted(const ModalModel& model) {
  return std::any_of(model.notes.begin(), model.notes.end(),
                     [](const Note& note) { return note.code == "resonances_distorted"; });
}

TEST(ResonanceDistortion, OneFrfTellsFrequencyAtSmallAmplitudeToSecondOrder) {
  testing::DefectiveFrfOptions options = plate(3);
  options.softening = 0.2;
  options.points = 1;
  const FrfSet set = testing::defective_frfs(options);
  ModalModel model;
  for (const double f : options.frequency_hz) {
    const double w = 2 * std::numbers::pi * f;
    IdentifiedMode mode;
    mode.pole_rad_s = {-options.damping_ratio * w, w};
    mode.shape = mode.participation = Eigen::VectorXcd::Ones(1);
    model.modes.push_back(mode);
  }
  std::vector<Note> notes;
  const ModalBand band = select_band(set, 0, 0, notes);
  for (const std::size_t r : {0U, 2U}) {  // the second has its node nearby
    const ResonanceDistortion one = resonance_distortion(set, band, model, r);
    EXPECT_LT(one.chance, 1e-4);
    EXPECT_LT(one.b.imag(), 0);  // softening
    // The next term of the series is b^2 / 2 at five times the decay rate: what it moves the pole
    // by is below b^2 of the half bandwidth.
    const double half = -model.modes[r].pole_rad_s.real();
    EXPECT_NEAR(one.small_pole.imag(), model.modes[r].pole_rad_s.imag(),
                std::norm(one.b) * half + 3 * one.small_std);
    EXPECT_GT(one.shift.imag(), 3 * one.small_std);
  }
}

TEST(ResonanceDistortion, CubicSpringWithoutSizesOfHitsIsWithinIntervals) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    testing::DefectiveFrfOptions options = plate(seed);
    options.softening = 0.3;
    options.points = seed % 2 == 0 ? 1 : 8;
    const ModalResult found = identify_modes(testing::defective_frfs(options));
    EXPECT_TRUE(noted(found.model)) << seed;
    for (const IdentifiedMode& mode : found.model.modes) {
      if (mode.doubtful) continue;
      const double away = (options.frequency_hz.array() - mode.frequency_hz.value).abs().minCoeff();
      EXPECT_LT(away, 3 * mode.frequency_hz.std) << seed;
    }
  }
}

// Intervals of sure modes reach to small amplitude: none of 12 modes misses.
TEST(ResonanceDistortion, IntervalsOfRovingHitsReachToSmallAmplitude) {
  int sure = 0, missed = 0;
  for (std::uint64_t seed = 6; seed <= 9; ++seed) {
    testing::DefectiveFrfOptions options = plate(seed);
    options.softening = 0.3;
    for (const IdentifiedMode& mode :
         identify_modes(testing::defective_frfs(options)).model.modes) {
      if (mode.doubtful) continue;
      const double away = (options.frequency_hz.array() - mode.frequency_hz.value).abs().minCoeff();
      ++sure;
      missed += away > 1.96 * mode.frequency_hz.std;
    }
  }
  EXPECT_GT(sure, 4);
  EXPECT_EQ(missed, 0);
}

// Chance below 1e-4 a set: none of 30.
TEST(ResonanceDistortion, LinearStructuresAreNotCalledNonLinear) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    testing::DefectiveFrfOptions options = plate(seed);
    options.points = 1;
    if (seed % 3 == 0) options.noise = 0.02;
    if (seed % 3 == 1) options.common = 0.02;
    const ModalResult found = identify_modes(testing::defective_frfs(options));
    EXPECT_FALSE(noted(found.model)) << seed;
  }
}

// One hit on a structure with a cubic spring: sums and differences of the modes' frequencies stand
// out of the noise by far.
TEST(ResonanceDistortion, SumsOfFrequenciesAfterOneHitAreNotSureModes) {
  testing::StrikeOptions strike;
  strike.hits = 1;
  strike.cubic = -0.3;
  const testing::StruckStructure structure(1);
  const std::vector<std::string> responses{"a1"};
  for (strike.seed = 1; strike.seed <= 2; ++strike.seed) {
    ImpactTestOptions options;
    options.hits.band_hz = {3, 70};
    const ImpactTest test =
        analyse_impact_test(struck_recordings(structure, strike), "force", responses, options);
    ModalOptions band;
    band.low_hz = 3;
    band.high_hz = 70;
    const ModalResult found = identify_modes(test.frfs, band);
    EXPECT_TRUE(noted(found.model));
    for (const IdentifiedMode& mode : found.model.modes) {
      const double f = mode.frequency_hz.value;
      const double away = (structure.frequency_hz.array() / f - 1).abs().minCoeff();
      EXPECT_TRUE(mode.doubtful || away < 0.03) << strike.seed << ": " << f << " Hz";
    }
  }
}

}  // namespace
}  // namespace rigfit::signal
