#include "signal/modal/band_background.h"

#include "signal/modal/modal_identification.h"
#include "signal/numerics/numbers.h"
#include "tests/test.h"

namespace rigfit::signal::modes_beside_test {

constexpr double kDamping = 0.012;

/// Accelerances of modes at 7.2, 14.5, 21.9, 38.2, 47.06, 56.9 and 66.7 Hz, 1.2 % damped, at two
/// points to 80 Hz, with noise over the rms FRF.
FrfSet struck_cable(double noise) {
  FrfSet set{.form = FrfForm::accelerance};
  set.frequency_hz = VectorXd::LinSpaced(480, 1.0 / 6, 80);
  const VectorXcd s = Complex(0, kTwoPi) * set.frequency_hz.cast<Complex>();
  set.H = MatrixXcd::Zero(480, 2);
  int number = 0;
  for (const double f : {7.2, 14.5, 21.9, 38.2, 47.06, 56.9, 66.7}) {
    ++number;
    const double w = kTwoPi * f;
    for (Index c = 0; c < 2; ++c) {
      const double size = std::sin(0.9 * number) * std::sin((0.9 + 0.4 * double(c)) * number);
      set.H.col(c).array() +=
          size * s.array().square() / (s.array().square() + 2 * kDamping * w * s.array() + w * w);
    }
  }
  Normal normal(5);
  const double rms = set.H.norm() / std::sqrt(960.0);
  for (Complex& h : set.H.reshaped()) h += noise * rms * Complex(normal(), normal());
  set.responses = {{"p1", 1, 3}, {"p2", 2, 3}};
  set.inputs = {{"hammer", 9, 3}};
  return set;
}

ModalOptions to_50_hz() { return {.low_hz = 2, .high_hz = 50}; }

TEST(ModesBeside, PolesWithinAQuarterOfTheBandBeyondItsEnd) {
  const FrfSet set = struck_cable(1e-4);
  std::vector<Note> notes;
  const ModalBand band = select_band(set, 2, 50, notes);
  // 62 Hz is as far as is looked; below 2 Hz there are 12 lines, too few.
  const VectorXcd poles = poles_beside(set, band, {});
  ASSERT_EQ(poles.size(), 1);
  // Its half-power bandwidth is 1.37 Hz; a hundredth of it is a hundred times what noise gives and
  // leaves room for what 66.7 Hz, beyond these lines, adds.
  EXPECT_NEAR(std::abs(poles[0]) / kTwoPi, 56.9, 1e-2 * 2 * kDamping * 56.9);
  const ModalBand all = select_band(set, 0, 0, notes);
  EXPECT_EQ(poles_beside(set, all, {}).size(), 0);
}

// 25 lines around the end of a band 11 Hz wide: fewer than the 32 that searches by parts take else.
TEST(ModesBeside, FewLinesAreEnough) {
  const FrfSet set = struck_cable(1e-4);
  std::vector<Note> notes;
  const VectorXcd poles = poles_beside(set, select_band(set, 44, 55, notes), {});
  ASSERT_EQ(poles.size(), 1);
  // A tenth of its half-power bandwidth: the lines end 0.8 Hz above it, 66.7 Hz lies beyond.
  EXPECT_NEAR(std::abs(poles[0]) / kTwoPi, 56.9, 0.1 * 2 * kDamping * 56.9);
}

// Where the lines end at 50 Hz, two residual terms leave damping off by up to 3.4e-4 here. With
// what the lines beyond tell it is known to noise: standard deviations are 2e-6 to 5e-6 of it.
TEST(ModesBeside, TheLastModeOfABandKeepsItsDamping) {
  const ModalResult result = identify_modes(struck_cable(1e-5), to_50_hz());
  ASSERT_EQ(result.model.modes.size(), 5u);
  for (const IdentifiedMode& mode : result.model.modes) {
    EXPECT_NEAR(mode.damping_ratio.value, kDamping, 5e-5 * kDamping) << mode.frequency_hz.value;
    EXPECT_LT(mode.frequency_hz.value, 50);
  }
}

// Columns: s, given; s^-2, s^4, s^-4 and s^6, the next of the residual terms; what the pole adds.
TEST(ModesBeside, ColumnsAreOrthonormalAndOnlyWhatIsNew) {
  std::vector<Note> notes;
  ModalBand band = select_band(struck_cable(0), 2, 50, notes);
  const MatrixXcd given = cut_off_background(band.lines.s, band.lines.power, 0, 0);
  set_background(given, band);
  const MatrixXcd& columns = band.lines.background;
  EXPECT_EQ(columns.cols(), 5);
  band.beside = VectorXcd::Constant(1, Complex(-4, kTwoPi * 56.9));
  set_background(given, band);
  const Index once = columns.cols();
  EXPECT_GE(once, 6);
  EXPECT_EQ(columns.col(0), given.col(0));
  // The same pole again is nothing new.
  band.beside = VectorXcd::Constant(2, Complex(-4, kTwoPi * 56.9));
  set_background(given, band);
  EXPECT_EQ(columns.cols(), once);
  EXPECT_LT((columns.adjoint() * columns - MatrixXcd::Identity(once, once)).norm(), 1e-12);
  EXPECT_LT((columns.adjoint() * band.lines.s.array().square().matrix()).norm(),
            1e-12 * band.lines.s.array().square().matrix().norm());
}

// One response to modes 5 % damped, the last above the band or the first below it, noise of 3 %.
// With two residual terms the last mode, or the first, inside is 3.7 to 5.0 standard deviations
// off.
TEST(ModesBeside, ModesFarBelowAndAboveTheBandLeaveDampingAlone) {
  FrfSet set{.responses = {{"p1", 1, 3}}, .inputs = {{"h", 9, 3}}, .form = FrfForm::accelerance};
  set.frequency_hz = VectorXd::LinSpaced(1000, 0.25, 250);
  const ArrayXcd s = Complex(0, 1) * set.frequency_hz.cast<Complex>();  // over 2 pi
  for (const bool above : {true, false}) {
    Normal normal(3);
    for (int record = 0; record < 2; ++record) {
      set.H = MatrixXcd::Zero(1000, 1);
      for (const double f :
           {20.0, above ? 45.0 : 60.0, above ? 81.0 : 90.0, above ? 160.0 : 131.0}) {
        set.H.array() += s.square() / (s.square() + 0.1 * f * s + f * f);
      }
      for (Complex& h : set.H.reshaped()) h += 0.03 * Complex(normal(), normal());
      const auto found = identify_modes(set, {above ? 5.0 : 50.0, above ? 100.0 : 160.0});
      EXPECT_EQ(found.model.modes.size(), 3u);
      for (const IdentifiedMode& mode : found.model.modes) {
        EXPECT_LT(std::abs(mode.damping_ratio.value - 0.05), 3.5 * mode.damping_ratio.std);
      }
    }
  }
}

// The mode at 56.9 Hz has a half bandwidth of 0.68 Hz.
TEST(ModesBeside, OneWhoseResonanceReachesIntoTheBandIsNamed) {
  const FrfSet set = struck_cable(1e-4);
  const ModalResult cut = identify_modes(set, {.low_hz = 2, .high_hz = 56.5});
  EXPECT_TRUE(says(cut.model.notes, "modes_beside"));
  const ModalResult far = identify_modes(set, {.low_hz = 2, .high_hz = 56});
  EXPECT_FALSE(says(far.model.notes, "modes_beside"));
}

TEST(ModesBeside, AFitThatDoesNotConvergeWithThemSaysSo) {
  ModalOptions options = to_50_hz();
  options.refine.max_iterations = 1;  // no fit settles
  options.refine.step_in_std = 1e-12;
  const ModalResult result = identify_modes(struck_cable(1e-4), options);
  EXPECT_TRUE(says(result.model.notes, "modes_beside"));
  EXPECT_GE(result.model.modes.size(), 4u);  // five are there; the diagram's poles are near them
}

}  // namespace rigfit::signal::modes_beside_test
