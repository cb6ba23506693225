#include "signal/spectra/frf_checks.h"

#include "tests/reference/ten_mode_truth.h"
#include "tests/test.h"

namespace rigfit::signal::frf_checks_test {

const testing::TenModeTruth& truth() {
  static const testing::TenModeTruth kTruth = testing::ten_mode_truth();
  return kTruth;
}

/// 0.25 Hz lines to 1400 Hz.
FrfSet exact(double decay_rate = 0) {
  return truth().frfs(VectorXd::LinSpaced(5601, 0, 1400), decay_rate);
}

TEST(DrivingPoint, IsConsistentWhereItIsAndNowhereElse) {
  for (const double rate : {0.0, 5.0}) {
    const FrfSet frfs = exact(rate);
    for (Index j = 0; j < 20; ++j) {
      const DrivingPointCheck check = check_driving_point(frfs, j, 0);
      EXPECT_EQ(check.verdict == DrivingPointVerdict::consistent, j == truth().driving_point) << j;
      if (j == truth().driving_point) {
        EXPECT_EQ(check.wrong_sign_share, 0);  // passivity is exact
      }
    }
  }
}

TEST(DrivingPoint, ReversedAndDelayedChannelsAreToldApart) {
  FrfSet frfs = exact();
  frfs.H = -frfs.H;
  EXPECT_EQ(check_driving_point(frfs, truth().driving_point, 0).verdict,
            DrivingPointVerdict::inverted);
  // A delay of 0.5 ms turns the phase by 180 degrees at 1 kHz.
  frfs = exact();
  for (Index k = 0; k < frfs.H.rows(); ++k) {
    frfs.H.row(k) *= std::polar(1.0, -3.14159265358979e-3 * frfs.frequency_hz[k]);
  }
  EXPECT_EQ(check_driving_point(frfs, truth().driving_point, 0).verdict,
            DrivingPointVerdict::inconsistent);
}

TEST(DrivingPoint, NoiseAloneIsUnclear) {
  FrfSet frfs = exact();
  frfs.H_std = frfs.H.cwiseAbs() * 10;
  EXPECT_EQ(check_driving_point(frfs, truth().driving_point, 0).verdict,
            DrivingPointVerdict::unclear);
}

TEST(Reciprocity, HoldsWithinItsErrorBars) {
  // Two inputs at two of the responses, with noise of known size.
  testing::TenModeTruth other = truth();
  other.driving_point = 11;
  const FrfSet a = exact(), b = other.frfs(a.frequency_hz);
  FrfSet both = a;
  both.inputs = {a.responses[truth().driving_point], a.responses[11]};
  both.H.resize(a.H.rows(), 40);
  for (Index j = 0; j < 20; ++j) {
    both.H.col(2 * j) = a.H.col(j);
    both.H.col(2 * j + 1) = b.H.col(j);
  }
  auto checks = check_reciprocity(both);
  ASSERT_EQ(checks.size(), 1u);
  EXPECT_LT(checks[0].difference, 1e-12);

  Normal normal(2);
  both.H_std = MatrixXd::Constant(both.H.rows(), 40, 0.01);
  both.H = both.H.unaryExpr(
      [&](const Complex& h) { return h + Complex(0.01 * normal(), 0.01 * normal()); });
  checks = check_reciprocity(both);
  ASSERT_EQ(checks.size(), 1u);
  // 11,202 squared Gaussians: 1.4 % in the square, 0.7 % in its root.
  EXPECT_NEAR(checks[0].difference / checks[0].from_noise, 1, 0.03);
  both.H.col(both.column(11, 0)) *= -1;
  EXPECT_GT(check_reciprocity(both)[0].difference, 1);
}

}  // namespace rigfit::signal::frf_checks_test
