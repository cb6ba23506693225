#include "signal/sinusoids/damped_sinusoids.h"

#include "tests/test.h"

namespace rigfit::signal::damped_sinusoids_test {

VectorXd decay(const std::vector<Complex>& poles, const std::vector<Complex>& amplitudes, Index n,
               double offset = 0, double drift = 0) {
  VectorXd y(n);
  for (Index j = 0; j < n; ++j) {
    const double t = static_cast<double>(j);
    y(j) = offset + drift * t / static_cast<double>(n);
    for (std::size_t m = 0; m < poles.size(); ++m) {
      y(j) += (amplitudes[m] * std::exp(poles[m] * t)).real();
    }
  }
  return y;
}

TEST(DampedSinusoids, RecoversManufacturedModesToRounding) {
  const std::vector<Complex> poles{{-0.01, 0.6}, {-0.003, 1.7}};
  const std::vector<Complex> amplitudes{{1.0, -0.5}, {0.2, 0.3}};
  const auto y = decay(poles, amplitudes, 700, 0.4, -0.2);
  const std::vector<Complex> start{{-0.008, 0.602}, {-0.004, 1.699}};
  const auto fit = fit_damped_sinusoids(y, start);
  ASSERT_EQ(fit.end, StepsEnd::converged);
  for (std::size_t m = 0; m < 2; ++m) {
    // Rounding of the data (1e-16) times the conditioning of a pole over 700 samples (below 1).
    EXPECT_LT(std::abs(fit.poles[m] - poles[m]), 1e-14);
    EXPECT_LT(std::abs(fit.amplitudes[m] - amplitudes[m]), 1e-13);
  }
  EXPECT_NEAR(fit.offset, 0.4, 1e-13);
  EXPECT_NEAR(fit.drift, -0.2, 1e-13);
  EXPECT_LT(fit.residual.cwiseAbs().maxCoeff(), 1e-13);
}

TEST(DampedSinusoids, GramMatrixIsThatOfTheDifferencedModel) {
  // J by central differences of the model: step h = 1e-6 leaves h^2 and eps / h, both 1e-10 of the
  // column (times N^2 for poles, whose columns grow with j).
  const std::vector<Complex> poles{{-0.02, 0.5}};
  const std::vector<Complex> amplitudes{{0.8, 0.6}};
  const Index n = 60;
  auto y = decay(poles, amplitudes, n, 0.1, 0.3);
  std::vector<Index> missing{3, 17, 18};
  for (Index j : missing) y(j) = 0;
  DampedSinusoidsOptions at_start;
  at_start.max_iterations = 0;
  const auto fit = fit_damped_sinusoids(y, poles, at_start, missing);
  MatrixXd J(n, 6);
  const double h = 1e-6;
  for (int k = 0; k < 6; ++k) {
    const auto at = [&](double s) {
      auto p = poles;
      auto a = amplitudes;
      double offset = 0.1, drift = 0.3;
      if (k == 0) a[0] += Complex(s, 0);
      if (k == 1) a[0] += Complex(0, s);
      if (k == 2) p[0] += Complex(s, 0);
      if (k == 3) p[0] += Complex(0, s);
      if (k == 4) offset += s;
      if (k == 5) drift += s;
      return decay(p, a, n, offset, drift);
    };
    J.col(k) = (at(h) - at(-h)) / (2 * h);
    EXPECT_TRUE(testing::MatricesNear(J.col(k), fit.jacobian_rows(0, fit.samples).col(k), 1e-6));
  }
  for (Index j : missing) J.row(j).setZero();
  const MatrixXd gram = J.transpose() * J;
  EXPECT_TRUE(testing::MatricesNear(gram, fit.jacobian_gram, 1e-8 * gram.cwiseAbs().maxCoeff()));
}

TEST(DampedSinusoids, LongDecaysNeitherUnderflowNorDriftInPhase) {
  // 2e6 samples: z^j falls to exp(-2000), and the recurrence restarts every block.
  const std::vector<Complex> poles{{-1e-3, 0.3}, {-1e-6, 0.9}};
  const std::vector<Complex> amplitudes{{1.0, 0.2}, {0.5, 0}};
  const auto y = decay(poles, amplitudes, 2000000);
  const std::vector<Complex> start{{-1.02e-3, 0.30001}, {-1.1e-6, 0.9 + 1e-7}};
  const auto fit = fit_damped_sinusoids(y, start);
  ASSERT_EQ(fit.end, StepsEnd::converged);
  // exp(p j) itself carries eps |p| j of phase error in the test's data: 2e-10 at the end.
  EXPECT_LT(std::abs(fit.poles[0] - poles[0]), 1e-12);
  EXPECT_LT(std::abs(fit.poles[1] - poles[1]), 1e-15);
}

}  // namespace rigfit::signal::damped_sinusoids_test
