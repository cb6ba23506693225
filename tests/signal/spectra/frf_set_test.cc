#include "signal/spectra/frf_set.h"
#include "tests/reference/ten_mode_truth.h"
#include "tests/test.h"

namespace rigfit::signal::frf_set_test {

FrfSet accelerances(double decay_rate) {
  FrfSet set = testing::ten_mode_truth(3).frfs(Eigen::VectorXd::LinSpaced(200, 0, 199), decay_rate);
  set.H_std = 0.01 * set.H.cwiseAbs();
  set.coherence = Eigen::MatrixXd::Constant(200, 3, 0.9);
  return set;
}

TEST(FrfSet, ThereAndBackIsTheSameWithoutTheLineAtZero) {
  for (const double rate : {0.0, 3.0}) {
    const FrfSet set = accelerances(rate);
    const FrfSet receptance = converted(set, FrfForm::receptance);
    EXPECT_EQ(receptance.form, FrfForm::receptance);
    EXPECT_EQ(receptance.unit, "m/N");
    ASSERT_EQ(receptance.frequency_hz.size(), 199);
    EXPECT_EQ(receptance.coherence.rows(), 199);
    ASSERT_EQ(receptance.notes.size(), 1u);
    EXPECT_TRUE(receptance.H.allFinite());
    EXPECT_TRUE(MatricesNear(receptance.H_std, 0.01 * receptance.H.cwiseAbs(), 1e-18));
    const FrfSet back = converted(converted(receptance, FrfForm::mobility), FrfForm::accelerance);
    EXPECT_TRUE(MatricesNear(back.H, set.H.bottomRows(199), 1e-14 * set.H.cwiseAbs().maxCoeff()));
  }
}

TEST(FrfSet, ReceptanceOfOneModeAtRestIsItsCompliance) {
  // s^2 alpha(s) at the line s = a + i w, under an exponential window of rate a: dividing by
  // (i w)^2 instead would be wrong by (1 + a / i w)^2, 2 a / w = 10 % at 10 Hz for a = 3.
  FrfSet set{.frequency_hz = Eigen::VectorXd::Constant(1, 10),
             .responses = {{"y", 1, 3}},
             .inputs = {{"f", 1, 3}},
             .form = FrfForm::accelerance,
             .exponential_decay_rate_1_s = 3};
  const Complex s(3, 2 * EIGEN_PI * 10);
  const Complex alpha = 1.0 / (s * s + 2 * 0.01 * 100 * s + 1e4);
  set.H = Eigen::MatrixXcd::Constant(1, 1, s * s * alpha);
  EXPECT_LT(std::abs(converted(set, FrfForm::receptance).H(0, 0) - alpha),
            1e-15 * std::abs(alpha) * 10);
}

TEST(FrfSet, UnknownFormsAreNotConverted) {
  FrfSet set = accelerances(0);
  EXPECT_THROW((void)converted(set, FrfForm::unknown), std::invalid_argument);
  set.form = FrfForm::unknown;
  EXPECT_THROW((void)converted(set, FrfForm::receptance), std::invalid_argument);
  EXPECT_STREQ(name_of(set.form), "unknown");
}

}  // namespace rigfit::signal::frf_set_test
