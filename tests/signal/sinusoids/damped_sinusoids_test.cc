#include "signal/sinusoids/damped_sinusoids.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>

namespace rigfit::signal::damped_sinusoids_test {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

Eigen::VectorXd decay(const std::vector<Complex>& poles, const std::vector<Complex>& amplitudes,
                      Index n, double offset = 0, double drift = 0) {
  Eigen::VectorXd y(n);
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
  const auto fit = fit_damped_sinusoids(even_samples(y), start);
  ASSERT_TRUE(fit.converged);
  for (std::size_t m = 0; m < 2; ++m) {
    // Rounding of the data (1e-16) times the conditioning of a pole over 700 samples (below 1).
    EXPECT_LT(std::abs(fit.poles[m] - poles[m]), 1e-14);
    EXPECT_LT(std::abs(fit.amplitudes[m] - amplitudes[m]), 1e-13);
  }
  EXPECT_NEAR(fit.offset, 0.4, 1e-13);
  EXPECT_NEAR(fit.drift, -0.2, 1e-13);
  EXPECT_LT(fit.residual.cwiseAbs().maxCoeff(), 1e-13);
}

/// (J'J)^-1 of one mode on an offset and a drift, J by central differences of step 1e-6: 1e-10.
Eigen::MatrixXd differenced_covariance(Complex pole, Complex amplitude, Index n,
                                       const std::vector<Index>& missing) {
  Eigen::MatrixXd J(n, 6);
  const double h = 1e-6;
  for (int k = 0; k < 6; ++k) {
    const auto at = [&](double s) {
      const Complex da(k == 0 ? s : 0, k == 1 ? s : 0), dp(k == 2 ? s : 0, k == 3 ? s : 0);
      return decay({pole + dp}, {amplitude + da}, n, k == 4 ? s : 0, k == 5 ? s : 0);
    };
    J.col(k) = (at(h) - at(-h)) / (2 * h);
  }
  for (const Index j : missing) J.row(j).setZero();
  return (J.transpose() * J).inverse().topLeftCorner(4, 4);
}

TEST(DampedSinusoids, CovarianceIsThatOfTheDifferencedModel) {
  // All lines are all samples; with samples missing the fit is in time.
  const Complex pole(-0.02, 0.5), amplitude(0.8, 0.6);
  for (const std::vector<Index>& missing : {std::vector<Index>{}, std::vector<Index>{3, 17, 18}}) {
    for (const Index n : {60, 61}) {
      Eigen::VectorXd y = decay({pole}, {amplitude}, n, 0.1, 0.3);
      for (const Index j : missing) y(j) = std::nan("");
      DampedSinusoidsOptions at_start;
      at_start.max_iterations = 0;
      const auto fit = fit_damped_sinusoids(even_samples(y), std::span(&pole, 1), at_start);
      ASSERT_TRUE(fit.usable());
      const Eigen::MatrixXd expected = differenced_covariance(pole, amplitude, n, missing);
      EXPECT_LT((fit.unit_covariance - expected).norm(), 1e-6 * expected.norm()) << n;
    }
  }
}

// A band of 0.05 to 0.12 cycles a sample: the mode at 0.08 comes out although a stronger one beside
// the band, an offset and a drift are not modelled. What the polynomial of second degree leaves of
// the other mode's skirt, 1 / (f - 0.2), is under 1 % of it: 3e-3 of the peak in the pole's width.
TEST(DampedSinusoids, ABandHoldsAModeBesideOthers) {
  const Complex pole(-0.005, 0.5), other(-0.004, 1.26);
  const auto y = decay({pole, other}, {{1, 0}, {3, 1}}, 2000, 5, 2);
  DampedSinusoidsOptions band;
  band.low = 0.05, band.high = 0.12;
  const Complex start(-0.006, 0.501);
  const auto fit = fit_damped_sinusoids(even_samples(y), std::span(&start, 1), band);
  ASSERT_TRUE(fit.converged);
  EXPECT_LT(std::abs(fit.poles[0] - pole), 3e-3 * 0.005);
}

TEST(DampedSinusoids, UnevenTimesAndAnOffsetThatDecaysAreFittedAsTheyAre) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> shift(-0.3, 0.3);
  DecaySamples samples;
  samples.even = false, samples.span = 400;
  samples.t = samples.y = Eigen::VectorXd(400);
  const Complex pole(-0.01, 0.6), amplitude(1, -0.5);
  for (Index j = 0; j < 400; ++j) {
    const double t = j == 0 ? 0 : static_cast<double>(j) + shift(random);
    samples.t(j) = t;
    samples.y(j) = (amplitude * std::exp(pole * t)).real() + 0.7 * std::exp(-0.02 * t) + 0.1;
  }
  DampedSinusoidsOptions relaxing;
  relaxing.relaxation = 0.03;
  const Complex start(-0.012, 0.602);
  const auto fit = fit_damped_sinusoids(samples, std::span(&start, 1), relaxing);
  ASSERT_TRUE(fit.converged);
  EXPECT_LT(std::abs(fit.poles[0] - pole), 1e-11);
  EXPECT_NEAR(*fit.relaxation, 0.02, 1e-9);
  EXPECT_NEAR(fit.relaxation_amplitude, 0.7, 1e-9);
}

TEST(DampedSinusoids, LeavesMissingSamplesOut) {
  const std::vector<Complex> poles{{-0.01, 0.6}};
  const std::vector<Complex> amplitudes{{1.0, 0.2}};
  auto y = decay(poles, amplitudes, 300, 0.2, 0.1);
  for (Index j = 40; j < 55; ++j) y(j) = std::nan("");
  const std::vector<Complex> start{{-0.012, 0.601}};
  const auto fit = fit_damped_sinusoids(even_samples(y), start);
  EXPECT_LT(std::abs(fit.poles[0] - poles[0]), 1e-14);
  EXPECT_EQ(fit.degrees, 300 - 15 - 6);
}

TEST(DampedSinusoids, TwiceTheSamePoleIsRankDeficient) {
  const std::vector<Complex> poles{{-0.01, 0.6}};
  const std::vector<Complex> amplitudes{{1.0, 0.2}};
  const auto y = decay(poles, amplitudes, 300);
  const std::vector<Complex> start{poles[0], poles[0]};
  const auto fit = fit_damped_sinusoids(even_samples(y), start);
  EXPECT_FALSE(fit.usable());
}

TEST(DampedSinusoids, RefusesFewerSamplesThanParameters) {
  const std::vector<Complex> start{{-0.01, 0.6}};
  EXPECT_FALSE(fit_damped_sinusoids(even_samples(Eigen::VectorXd::Random(6)), start).usable());
}

TEST(DampedSinusoids, LongDecaysNeitherUnderflowNorDriftInPhase) {
  // 2e5 samples: z^j falls to exp(-2000), and the recurrence restarts every block.
  const std::vector<Complex> poles{{-1e-2, 0.3}, {-1e-5, 0.9}};
  const std::vector<Complex> amplitudes{{1.0, 0.2}, {0.5, 0}};
  const auto y = decay(poles, amplitudes, 200000);
  const std::vector<Complex> start{{-1.02e-2, 0.3001}, {-1.1e-5, 0.9 + 1e-6}};
  const auto fit = fit_damped_sinusoids(even_samples(y), start);
  ASSERT_TRUE(fit.converged);
  // exp(p j) itself carries eps |p| j of phase error in the test's data: 2e-11 at the end.
  EXPECT_LT(std::abs(fit.poles[0] - poles[0]), 1e-12);
  EXPECT_LT(std::abs(fit.poles[1] - poles[1]), 1e-14);
}

}  // namespace
}  // namespace rigfit::signal::damped_sinusoids_test
