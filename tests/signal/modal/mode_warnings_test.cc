#include "signal/modal/mode_hits.h"

#include "signal/modal/modal_identification.h"
#include "signal/numerics/numbers.h"
#include "tests/reference/defective_frfs.h"
#include "tests/test.h"

namespace rigfit::signal::mode_warnings_test {

/// One FRF that is 1 on 200 lines 0.1 Hz apart, and a mode at 10 Hz, 5 % damped: 11 lines.
struct Around {
  ModalBand band;
  FrfNoise noise;
  IdentifiedMode mode;

  Around() {
    band.frequency_hz = VectorXd::LinSpaced(200, 0.1, 20);
    band.spacing_hz = 0.1;
    band.lines.H = MatrixXcd::Ones(200, 1);
    noise = noise_unknown(band.lines.H, 1, 0);
    mode.pole_rad_s = {-0.05 * 10 * kTwoPi, 10 * kTwoPi};
  }
  [[nodiscard]] double beyond(const MatrixXcd& misfit) const {
    return misfit_beyond_noise(band, noise, mode, misfit);
  }
};

// Four standard deviations of the correlation of 10 pairs are 0.9: chance of one in 30000.
TEST(MisfitBeyondNoise, TellsStructureFromNoiseByNeighbouringLines) {
  Around around;
  Normal normal(1);
  for (int trial = 0; trial < 200; ++trial) {
    MatrixXcd noise(200, 1);
    for (Complex& value : noise.reshaped()) value = Complex(normal(), normal());
    EXPECT_EQ(around.beyond(0.5 * noise), 0);
  }
  EXPECT_NEAR(around.beyond(MatrixXcd::Constant(200, 1, Complex(0.3, 0.4))), 0.5, 1e-9);
}

TEST(MisfitBeyondNoise, IsWhatErrorBarsDoNotExpect) {
  Around around;
  around.band.H_std = MatrixXd::Constant(200, 1, 0.3);
  // Twice 0.3^2 is expected, 0.5^2 + 0.4^2 left: 0.41 - 0.18.
  EXPECT_NEAR(around.beyond(MatrixXcd::Constant(200, 1, Complex(0.5, 0.4))), std::sqrt(0.23), 1e-9);
  EXPECT_EQ(around.beyond(MatrixXcd::Constant(200, 1, Complex(0.3, 0.3))), 0);
}

/// Three modes 0.5 % damped at six sensors, 0.25 Hz lines, noise on the force.
FrfSet six_sensors(double force_noise) {
  testing::DefectiveFrfOptions options;
  options.damping_ratio = 0.005, options.spacing_hz = 0.25;
  options.low_hz = 20, options.high_hz = 400;
  options.points = 6, options.points_are_inputs = false;
  options.common = force_noise;
  return testing::defective_frfs(options);
}

// Noise of the force as large as a third of it in a few lines of a resonance makes any width of
// it: error bars of first order do not say so.
TEST(ModeWarnings, ModesUnderMuchNoiseOnTheForceAreDoubtful) {
  for (const double force_noise : {0.02, 0.3}) {
    const ModalResult found = identify_modes(six_sensors(force_noise));
    ASSERT_GE(found.model.modes.size(), 3u);
    for (const IdentifiedMode& mode : found.model.modes) {
      EXPECT_EQ(mode.doubtful, force_noise > 0.1) << mode.doubt;
    }
  }
}

// A tone has a line to itself, so that the least damping fits best: no step would be the last.
TEST(ModeWarnings, ASteadyToneOnALineIsDoubtfulAndLeavesTheModesAlone) {
  FrfSet set = six_sensors(0);
  const ModalResult without = identify_modes(set);
  const Index line = 4 * (120 - 20);
  ASSERT_EQ(set.frequency_hz[line], 120);
  set.H.row(line).array() += 20;
  const ModalResult found = identify_modes(set);
  EXPECT_EQ(found.end, StepsEnd::converged) << name_of(found.end);
  ASSERT_EQ(without.model.modes.size(), 3u);
  ASSERT_EQ(found.model.modes.size(), 4u);
  EXPECT_THAT(found.model.modes[1].doubt, HasSubstr("a steady tone such as mains hum"));
  for (const std::size_t r : {0, 1, 2}) {
    const IdentifiedMode &mode = found.model.modes[r + (r > 0)], &was = without.model.modes[r];
    EXPECT_FALSE(mode.doubtful) << mode.doubt;
    EXPECT_NEAR(mode.frequency_hz.value, was.frequency_hz.value, was.frequency_hz.std);
    EXPECT_NEAR(mode.damping_ratio.value, was.damping_ratio.value, was.damping_ratio.std);
  }
}

// Lines 9 to 25 half bandwidths apart: hits of ours, whose records are as long as the lines tell,
// show as much of a mode as of a steady tone, FRFs from elsewhere may be of sines.
TEST(ModeWarnings, ModesBetweenLinesAreDoubtfulWhereHitsAreOursElseShownWithAWarning) {
  testing::DefectiveFrfOptions options;
  options.damping_ratio = 2e-4, options.spacing_hz = 0.5;
  options.points = 6, options.points_are_inputs = false;
  FrfSet set = testing::defective_frfs(options);
  for (const double before_s : {0.0, 0.01}) {
    set.pre_trigger_s = before_s;
    const ModalModel found = identify_modes(set).model;
    ASSERT_EQ(found.modes.size(), 3u);
    for (const auto& mode : found.modes) EXPECT_EQ(mode.doubtful, before_s > 0) << mode.doubt;
    EXPECT_EQ(says(found.notes, "steady_tone"), before_s == 0);
  }
}

// One FRF: what a cubic spring makes of a mode is a second pole that decays some three times as
// fast.
TEST(ModeWarnings, APoleWithinANarrowerOneIsNoSureMode) {
  FrfSet set = six_sensors(0);
  set.responses.resize(1);
  const ArrayXcd s = Complex(0, kTwoPi) * set.frequency_hz.array();
  const auto mode = [&](double hz, double decay) -> ArrayXcd {
    return ((s + decay).square() + std::pow(kTwoPi * hz, 2)).inverse();
  };
  for (const double wide : {1.0, 3.0}) {
    set.H = (mode(100, 6) + 0.5 * mode(102.5, 6 * wide)).matrix();
    Normal normal(1);
    for (Complex& h : set.H.reshaped()) h *= 1.0 + 1e-3 * Complex(normal(), normal());
    const ModalResult found = identify_modes(set);
    ASSERT_EQ(found.model.modes.size(), 2u);
    EXPECT_FALSE(found.model.modes[0].doubtful) << found.model.modes[0].doubt;
    EXPECT_EQ(found.model.modes[1].doubtful, wide > 1) << found.model.modes[1].doubt;
  }
}

// One FRF, two modes within a half bandwidth: one mode is found, and that it leaves more than noise
// is said.
TEST(ModeWarnings, AModeThatHidesWithinAnotherIsSaid) {
  int said = 0, alone = 0;
  for (int seed = 1; seed <= 10; ++seed) {
    for (const double hidden : {0.0, 0.7}) {
      FrfSet set = six_sensors(0);
      set.responses.resize(1);
      const ArrayXcd s = Complex(0, kTwoPi) * set.frequency_hz.array();
      const auto mode = [&](double hz) -> ArrayXcd {
        return ((s + 6.0).square() + std::pow(kTwoPi * hz, 2)).inverse();
      };
      set.H = (mode(100) + hidden * mode(100.7)).matrix();
      set.H_std = MatrixXd::Constant(set.H.rows(), 1, 0.01 * set.H.cwiseAbs().maxCoeff());
      Normal normal(seed);
      for (Complex& h : set.H.reshaped()) h += set.H_std(0, 0) * Complex(normal(), normal());
      const ModalResult found = identify_modes(set);
      const bool one = found.model.modes.size() == 1;
      (hidden > 0 ? said : alone) += one && says(found.model.notes, "systematic_misfit");
    }
  }
  EXPECT_GE(said, 9);
  EXPECT_LE(alone, 0);
}

// White misfit of 40 % at each line and FRF, error bars of 1 %: poles of all FRFs hold, the error
// bars do not.
TEST(ModeWarnings, AGlobalModeWithALargeMisfitIsDoubtful) {
  FrfSet set = six_sensors(0);
  Normal normal(1);
  for (Complex& h : set.H.reshaped()) h *= 1.0 + 0.3 * Complex(normal(), normal());
  set.H_std = 0.01 * set.H.cwiseAbs();
  const ModalResult found = identify_modes(set);
  ASSERT_EQ(found.model.modes.size(), 3u);
  for (const IdentifiedMode& mode : found.model.modes) {
    EXPECT_EQ(mode.refinement, "global");
    EXPECT_TRUE(mode.doubtful);
    EXPECT_THAT(mode.doubt, HasSubstr("not explained by it, nor by noise"));
  }
}

}  // namespace rigfit::signal::mode_warnings_test
