#include "signal/modal/band_background.h"

#include "signal/modal/modal_identification.h"
#include "signal/numerics/numbers.h"
#include "tests/reference/defective_frfs.h"
#include "tests/test.h"

namespace rigfit::signal::cut_off_records_test {

/// Accelerances of 8 s of a beam at 2.0924 Hz, of which `left` is left at the end.
testing::DefectiveFrfOptions beam(double left) {
  testing::DefectiveFrfOptions options;
  options.frequency_hz = (VectorXd(2) << 2.0924, 13.11).finished();
  options.record_s = 8;
  options.spacing_hz = 0.125, options.low_hz = 0.125, options.high_hz = 20;
  options.damping_ratio = -std::log(left) / (kTwoPi * 2.0924 * options.record_s);
  options.points = 3, options.points_are_inputs = false;
  options.noise = 1e-3;
  return options;
}

// A fit without background puts the first mode off by 5 to 30 standard deviations. Its residue is
// changed by exp(p T), as much as is left, which the shape's standard deviations contain.
TEST(CutOffRecords, PolesHoldWhateverTheRecordLeavesAndWhereverTheHitIs) {
  for (const double left : {0.1, 0.4}) {
    for (const double before_s : {0.0, 0.08, 0.4}) {
      testing::DefectiveFrfOptions options = beam(left);
      options.before_hit_s = before_s;
      const ModalResult result = identify_modes(testing::defective_frfs(options));
      ASSERT_EQ(result.model.modes.size(), 2u);
      const IdentifiedMode& mode = result.model.modes[0];
      EXPECT_FALSE(mode.doubtful) << mode.doubt;
      EXPECT_LT(std::abs(mode.frequency_hz.value - 2.0924), 4 * mode.frequency_hz.std);
      EXPECT_LT(std::abs(mode.damping_ratio.value - options.damping_ratio),
                4 * mode.damping_ratio.std);
      EXPECT_LT(mode.frequency_hz.std, 5e-4 * 2.0924);
      const Complex truth = 1.0 / Complex(0, 2 * mode.pole_rad_s.imag());
      for (Index o = 0; o < 3; ++o) {
        const double x = (static_cast<double>(o) + 0.63) / 3.37;
        const Complex residue = std::sin(kTwoPi / 2 * x) * std::sin(kTwoPi / 2 * 0.37) * truth;
        EXPECT_LT(std::abs(mode.shape[o] - residue), 1.96 * mode.shape_std.row(o).norm());
      }
      // Noise is 0.1 % of either part of the mean FRF; the background is part of what is rebuilt.
      EXPECT_LT(result.model.frf_error.maxCoeff(), 0.005);
    }
  }
}

// The noise is 0.14 % of the mean FRF; without the background several percent are missing.
TEST(CutOffRecords, FrfsRebuiltFromTheFitHaveTheBackground) {
  testing::DefectiveFrfOptions options = beam(0.4);
  options.before_hit_s = 0.4;
  const FrfSet set = testing::defective_frfs(options);
  const ModalResult result = identify_modes(set);
  ASSERT_EQ(result.background.rows(), result.lines_used);
  const auto misfit = [&](const FrfSet& rebuilt) {
    return (rebuilt.H - set.H).norm() / set.H.norm();
  };
  EXPECT_LT(misfit(synthesised(result, set.frequency_hz, set.form)), 2e-3);
  EXPECT_GT(misfit(synthesised(result.model, set.frequency_hz, set.form)), 2e-2);
  // Between the lines of the fit, in another form, and beyond its band.
  const FrfSet finer =
      synthesised(result, VectorXd::LinSpaced(400, 0.125, 25), FrfForm::receptance);
  EXPECT_TRUE(finer.H.allFinite());
  const FrfSet modes = synthesised(result.model, finer.frequency_hz, FrfForm::receptance);
  EXPECT_EQ(finer.H.row(399), modes.H.row(399));
  EXPECT_NE(finer.H.row(200), modes.H.row(200));
}

TEST(CutOffRecords, NoBackgroundForModesThatHaveDecayedOrSteadyTones) {
  FrfSet set;
  ModalBand band{.spacing_hz = 0.125};
  band.frequency_hz = VectorXd::LinSpaced(160, 0.125, 20);
  band.lines.s = Complex(0, kTwoPi) * band.frequency_hz.cast<Complex>();
  band.lines.power = 2;
  band.lines.H = MatrixXcd::Zero(160, 1);
  const auto allow = [&](double left) {
    const Complex pole(0.125 * std::log(left), 13);
    return allow_for_cut_off(set, VectorXcd::Constant(1, pole), MatrixXcd(), FrfNoise(), 4e9, band);
  };
  EXPECT_FALSE(allow(0.9e-3));
  EXPECT_FALSE(allow(0.95));
  EXPECT_EQ(band.lines.background.size(), 0);
  EXPECT_TRUE(allow(0.009));
  EXPECT_EQ(band.lines.background.cols(), 5);  // s, and the next of the residual terms
  EXPECT_TRUE(allow(0.02));
  const Index unknown = band.lines.background.cols();
  // One function of s, then what an eighth of 160 lines spans: 20, and some.
  EXPECT_GT(unknown, 20);
  EXPECT_LT(unknown, 30);
  set.pre_trigger_s = 0.08;
  EXPECT_TRUE(allow(0.02));
  EXPECT_LT(band.lines.background.cols(), unknown);
}

// Acceleration a p^2 exp(p t) and its conjugate from the hit to 0.08 s before a period of the lines
// has passed, transformed by hand: with poles, residual terms and background nothing is left.
TEST(CutOffRecords, WhereTheSpanOfAKnownLeadTakesTooMuchEachPoleAddsTwoFunctions) {
  constexpr double kLead = 0.08;
  FrfSet set;
  set.pre_trigger_s = kLead;
  ModalBand band{.spacing_hz = 0.125};
  band.frequency_hz = VectorXd::LinSpaced(160, 0.125, 20);
  const VectorXcd s = Complex(0, kTwoPi) * band.frequency_hz.cast<Complex>();
  band.lines.s = s, band.lines.power = 2, band.lines.H = MatrixXcd::Zero(160, 1);
  const Complex pole(-0.4, 30), residue(0.3, 1);
  ASSERT_TRUE(allow_for_cut_off(set, VectorXcd::Constant(1, pole), MatrixXcd(), FrfNoise(), 0,
                                band));  // no work for what t0 spans
  VectorXcd H = VectorXcd::Zero(160);
  MatrixXcd columns(160, 7);
  for (int k = 0; k < 2; ++k) {
    const Complex p = k == 0 ? pole : std::conj(pole), a = k == 0 ? residue : std::conj(residue);
    H.array() +=
        a * p * p * (1 - ((p - s.array()) * (1 / band.spacing_hz - kLead)).exp()) / (s.array() - p);
    columns.col(k) = s.array().square() / (s.array() - p);
  }
  columns.col(2) = s.array().square();
  columns.col(3).setOnes();
  columns.rightCols(3) = band.lines.background.leftCols(3);  // behind them terms of modes far away
  const auto left = [&](Index used) {
    const MatrixXcd X = columns.leftCols(used).colwise().normalized();
    return (H - X * X.householderQr().solve(H)).norm() / H.norm();
  };
  EXPECT_LT(left(7), 1e-9);
  EXPECT_GT(left(5), 1e-4);
}

// 400 sets of noise, whose variance rises sixteenfold along the lines: chance is below 1 in 1e4
// each.
TEST(CutOffRecords, TheMisfitShowsABackgroundAndNoiseShowsNone) {
  constexpr Index kLines = 160, kFrfs = 3;
  const VectorXd f = VectorXd::LinSpaced(kLines, 0.125, 20);
  const VectorXcd s = Complex(0, kTwoPi) * f.cast<Complex>();
  const MatrixXcd background = cut_off_background(s, 2, 0.4, 0);
  const VectorXd line = VectorXd::LinSpaced(kLines, 1, 16);
  Normal normal(3);
  int shown = 0;
  for (int set = 0; set < 400; ++set) {
    MatrixXcd misfit(kLines, kFrfs);
    for (Index k = 0; k < kLines; ++k) {
      for (Complex& one : misfit.row(k)) {
        one = std::sqrt(line[k]) * Complex(normal(), normal());
      }
    }
    shown += misfit_shows(background, misfit, line, 4);
    // Two and a half times as much in the span as the noise alone.
    for (Index c = 0; c < kFrfs; ++c) {
      misfit.col(c) += background * (background.adjoint() * misfit.col(c)) * 1.5;
    }
    EXPECT_TRUE(misfit_shows(background, misfit, line, 4));
  }
  EXPECT_LE(shown, 2);
}

}  // namespace rigfit::signal::cut_off_records_test
