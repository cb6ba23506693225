#include "signal/refinement/modal_noise.h"

#include "signal/refinement/modal_basis.h"
#include "signal/spectra/fft.h"
#include "tests/test.h"

namespace rigfit::signal::modal_noise_test {

struct NoisyFrfs {
  VectorXd q;
  VectorXd a = VectorXd::LinSpaced(8, 0.01, 0.08);
  double b = 4e-4;
  MatrixXcd H, error;
  MatrixXd std;
};

/// One resonance, q rising threefold over 4000 lines.
NoisyFrfs noisy_frfs(unsigned seed) {
  NoisyFrfs set;
  Normal normal(seed);
  const Index lines = 4000;
  set.q = VectorXd::LinSpaced(lines, 0.5, 1.5);
  set.H.resize(lines, 8);
  set.error.resize(lines, 8);
  set.std.resize(lines, 8);
  for (Index k = 0; k < lines; ++k) {
    const Complex common(normal(), normal());
    for (Index c = 0; c < 8; ++c) {
      set.H(k, c) = static_cast<double>(c + 1) * 300.0 / Complex(20, static_cast<double>(k - 2000));
      set.error(k, c) = std::sqrt(set.q[k]) * (std::sqrt(set.a[c]) * Complex(normal(), normal()) +
                                               std::sqrt(set.b) * set.H(k, c) * common);
      set.std(k, c) = std::sqrt(set.q[k] * (set.a[c] + set.b * std::norm(set.H(k, c))));
    }
  }
  return set;
}

TEST(ModalNoise, ErrorBarsBecomeTheirModel) {
  const NoisyFrfs set = noisy_frfs(1);
  const FrfNoise noise = noise_from_std(set.H, set.std, 1, 0);
  // Exact but for the averaging of q over a window of 51 lines, linear in between.
  EXPECT_TRUE(MatricesNear(noise.line.segment(30, 3940), set.q.segment(30, 3940), 0.01));
  EXPECT_TRUE(MatricesNear(noise.column, set.a, 0.01 * 0.08));
  EXPECT_NEAR(noise.common[0], set.b, 0.02 * set.b);
}

TEST(ModalNoise, ResidualsBecomeTheirModel) {
  const NoisyFrfs set = noisy_frfs(2);
  const FrfNoise noise = noise_from_residuals(set.H, set.error, VectorXd::Zero(4000), 1, 0);
  // a: 8000 squares each, 1.6 % standard deviation. b: the lines where b h > 1, some 200 of 400
  // squares: 7 %. q: 200 to 400 squares a window, 7 %.
  for (Index c = 0; c < 8; ++c) EXPECT_NEAR(noise.column[c], set.a[c], 0.06 * set.a[c]);
  EXPECT_NEAR(noise.common[0], set.b, 0.3 * set.b);
  EXPECT_LT((noise.line.array() / set.q.array() - 1).matrix().norm() / std::sqrt(4000.0), 0.12);
}

// b shows only in the lines of the peak, |H|^2 b > a: some 60 squares of 8000, 18 %.
TEST(ModalNoise, OneFrfShowsTheNoiseOfItsForceAtThePeak) {
  const NoisyFrfs set = noisy_frfs(3);
  const FrfNoise noise =
      noise_from_residuals(set.H.leftCols(1), set.error.leftCols(1), VectorXd::Zero(4000), 1, 0);
  EXPECT_NEAR(noise.common[0], set.b, 0.6 * set.b);
  EXPECT_TRUE(noise.line.allFinite());
}

TEST(ModalNoise, DeadFrfHasInfiniteVariance) {
  NoisyFrfs set = noisy_frfs(4);
  set.H.col(2).setZero();
  set.error.col(2).setZero();
  const FrfNoise noise = noise_from_residuals(set.H, set.error, VectorXd::Zero(4000), 1, 0);
  EXPECT_TRUE(std::isinf(noise.column[2]));
  EXPECT_TRUE(line_weight(noise, set.H).allFinite());
}

// Noise white in time under a window exp(-sigma t): the covariance of its lines is rho.
TEST(ModalNoise, LinesUnderAWindowAreCorrelatedAsSaid) {
  const Index n = 512;
  const double sigma_t = 3;
  Normal normal(5);
  RealFft fft(n);
  Complex sums[4] = {};
  double power = 0;
  const int runs = 400;
  for (int run = 0; run < runs; ++run) {
    for (Index t = 0; t < n; ++t) {
      fft.time()[t] = normal() * std::exp(-sigma_t * static_cast<double>(t) / n);
    }
    fft.forward();
    for (Index k = 20; k < 230; ++k) {
      power += std::norm(fft.spectrum()[k]);
      for (Index d = 1; d < 4; ++d) {
        sums[d] += fft.spectrum()[k + d] * std::conj(fft.spectrum()[k]);
      }
    }
  }
  FrfNoise noise{.correlation_lines = sigma_t};
  // rho as applied to a unit column: real part of column e_0 gives rho(d) at line d.
  MatrixXd unit = MatrixXd::Zero(20, 1);
  unit(0, 0) = 1;
  const MatrixXd rho = correlated(noise, unit);
  for (Index d = 1; d < 4; ++d) {
    const Complex measured = sums[d] / power, expected(rho(d, 0), rho(10 + d, 0));
    // 84000 correlated products, some 30000 free ones: 0.6 % standard deviation.
    EXPECT_LT(std::abs(measured - expected), 0.025) << d;
    EXPECT_LT(std::abs(expected - 1.0 / Complex(1, kPi * static_cast<double>(d) / 3)), 1e-12);
    // Counted from an instant t0 later, line k of the noise turns by exp(i 2 pi k t0 / T).
    FrfNoise later = noise;
    later.lead = 0.05;
    const Complex turn = std::polar(1.0, 2 * kPi * 0.05 * static_cast<double>(d));
    EXPECT_LT(std::abs(line_correlation(later, d) - turn * line_correlation(noise, d)), 1e-14);
  }
}

TEST(ModalNoise, CorrelationIsHermitian) {
  FrfNoise noise{.correlation_lines = 2};
  const MatrixXd rho = correlated(noise, MatrixXd::Identity(24, 24));
  EXPECT_TRUE(MatricesNear(rho, rho.transpose(), 1e-13));
  EXPECT_TRUE(MatricesNear(rho.diagonal(), VectorXd::Ones(24), 1e-13));
  noise.correlation_lines = 0;
  EXPECT_TRUE(MatricesNear(correlated(noise, rho), rho, 0));
}

}  // namespace rigfit::signal::modal_noise_test
