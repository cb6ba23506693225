#include "signal/spectra/frf_set.h"
#include "tests/reference/ten_mode_truth.h"
#include "tests/test.h"

namespace rigfit::signal::frf_set_test {

FrfSet accelerances(double decay_rate) {
  FrfSet set = testing::ten_mode_truth(3).frfs(VectorXd::LinSpaced(200, 0, 199), decay_rate);
  set.H_std = 0.01 * set.H.cwiseAbs();
  set.coherence = MatrixXd::Constant(200, 3, 0.9);
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
  FrfSet set{.frequency_hz = VectorXd::Constant(1, 10),
             .responses = {{"y", 1, 3}},
             .inputs = {{"f", 1, 3}},
             .form = FrfForm::accelerance,
             .exponential_decay_rate_1_s = 3};
  const Complex s(3, 2 * EIGEN_PI * 10);
  const Complex alpha = 1.0 / (s * s + 2 * 0.01 * 100 * s + 1e4);
  set.H = MatrixXcd::Constant(1, 1, s * s * alpha);
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

/// n averages of Y = H X + noise, white in lines: H1 and coherence of one FRF.
FrfSet averaged(int n, double noise, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto complex = [&] { return Complex(normal(random), normal(random)); };
  FrfSet set{.frequency_hz = VectorXd::LinSpaced(400, 1, 400)};
  set.responses.push_back({"a", 1, 3});
  set.inputs.push_back({"f", 2, 3});
  set.H.resize(400, 1);
  set.coherence.resize(400, 1);
  for (Index k = 0; k < 400; ++k) {
    double gxx = 0, gyy = 0;
    Complex gxy = 0;
    for (int i = 0; i < n; ++i) {
      const auto x = 1.0 + 0.3 * complex(), y = 2.0 * x + noise * complex();
      gxx += std::norm(x), gyy += std::norm(y), gxy += std::conj(x) * y;
    }
    set.H(k, 0) = gxy / gxx;
    set.coherence(k, 0) = std::norm(gxy) / (gxx * gyy);
  }
  return set;
}

// Errors over error bars, real and imaginary: 16,000 squares scatter by 1.1 %, the smoothed error
// bars of 21 lines by sqrt(1 / (21 (n - 1))) each, which raises the mean square by 2.4 % at n = 3
// and 0.6 % at n = 9; where the narrow average replaces the wide one by chance, it lowers it.
TEST(CoherenceErrors, ErrorBarsAreTheScatterOfTheFrf) {
  std::mt19937_64 random(2);
  for (const int n : {3, 9}) {
    double square = 0;
    for (int trial = 0; trial < 20; ++trial) {
      FrfSet set = averaged(n, 0.2, random);
      error_bars_from_coherence(set, n, {});
      square += ((set.H.array() - 2.0).abs2() / set.H_std.array().square()).sum() / (2 * 400 * 20);
      EXPECT_TRUE(set.notes.empty());
    }
    EXPECT_NEAR(square, 1, 0.06) << n;
  }
}

TEST(CoherenceErrors, SaysWhatIsNotKnown) {
  std::mt19937_64 random(3);
  FrfSet set = averaged(4, 3, random);
  error_bars_from_coherence(set, 0, std::pair(10.0, 300.0));
  EXPECT_TRUE(says(set.notes, "assumed"));
  EXPECT_TRUE(says(set.notes, "low_coherence"));
  EXPECT_TRUE((set.H_std.array() > 0).all());
  FrfSet one = averaged(4, 0.1, random);
  error_bars_from_coherence(one, 1, {});
  EXPECT_TRUE(says(one.notes, "coherence_unusable"));
  EXPECT_EQ(one.H_std.size(), 0);
  one.coherence *= 2;
  error_bars_from_coherence(one, 4, {});
  EXPECT_EQ(one.H_std.size(), 0);
}

}  // namespace rigfit::signal::frf_set_test
