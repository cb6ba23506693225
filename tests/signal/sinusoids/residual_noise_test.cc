#include "signal/sinusoids/residual_noise.h"

#include "signal/decay/decay.h"
#include "tests/signal/decays.h"
#include "tests/test.h"

namespace rigfit::signal::residual_noise_test {

VectorXd coloured(Index n, double colour, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  VectorXd y(n);
  double last = normal(generator) / std::sqrt(1 - colour * colour);
  for (double& v : y) v = last = colour * last + normal(generator);
  return y;
}

TEST(ResidualNoise, TellsWhiteFromColouredAndItsDensity) {
  const auto white = residual_noise(coloured(20000, 0, 1), 20000);
  EXPECT_LE(white.coefficients.size(), 1);
  EXPECT_NEAR(white.variance, 1, 0.04);  // four times sqrt(2/n)
  const auto red = residual_noise(coloured(20000, 0.8, 2), 20000);
  ASSERT_GE(red.coefficients.size(), 1);
  EXPECT_NEAR(red.coefficients(0), 0.8, 0.03);
  EXPECT_NEAR(red.innovation_variance, 1, 0.05);
  // S(0) = 1 / (1 - 0.8)^2 = 25: d ln S / da = 10, and a is known to 0.0042.
  EXPECT_NEAR(red.white_equivalent(0), 25, 25 * 0.17);
}

TEST(ResidualNoise, CovarianceOfACrowdOfFitsUnderColouredNoiseIsAsStated) {
  // 400 records of the same decay under AR(0.9) noise: scatter against the stated standard
  // uncertainty, both to sqrt(1/800) = 3.5 %, four times that allowed, plus the model order's
  // choice.
  const Complex pole(-0.01, 0.3);
  double squared = 0, stated = 0;
  for (unsigned seed = 0; seed < 400; ++seed) {
    VectorXd y = 0.05 * coloured(400, 0.9, seed + 10);
    for (Index j = 0; j < y.size(); ++j) y(j) += std::exp(pole * static_cast<double>(j)).real();
    const auto fit = fit_damped_sinusoids(y, std::span(&pole, 1));
    const auto covariance =
        fit_uncertainty(fit, residual_noise(fit.residual, fit.degrees)).covariance;
    squared += std::norm(fit.poles[0] - pole);
    stated += covariance(2, 2) + covariance(3, 3);
  }
  EXPECT_NEAR(squared / stated, 1, 0.3);
}

/// Re exp(p j) read at j + jitter, times 1 + multiplied, plus noise: standard normal times these.
VectorXd jittered(Complex pole, Index n, double jitter, double multiplied, double noise,
                  unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  VectorXd y(n);
  for (Index j = 0; j < n; ++j) {
    const double t = static_cast<double>(j) + jitter * normal(generator);
    y(j) = std::exp(pole * t).real() * (1 + multiplied * normal(generator)) +
           noise * normal(generator);
  }
  return y;
}

FitUncertainty of(const VectorXd& y, Complex pole, Index order = 0) {
  const auto fit = fit_damped_sinusoids(y, std::span(&pole, 1));
  auto noise = residual_noise(fit.residual, fit.degrees);
  noise.coefficients = VectorXd::Zero(order);
  return fit_uncertainty(fit, noise);
}

// With x = 2 a t, 12 of it in the record, a decay is read with weights (x - 1)^2 exp(-x), frequency
// where the sine of its phase is large, damping where the cosine is. Jitter has the variance
// exp(-x) sin^2, its mean over the record (1 / 12) / 2:
//   integral of (x - 1)^2 exp(-2 x) over that of (x - 1)^2 exp(-x): 1/4,
//   mean of sin^4 over that of sin^2, squared: 1.5; of sin^2 cos^2: 0.5.
// So frequency has 12 / 4 * 1.5 = 4.5 times the variance of even noise, damping 1.5 times; noise in
// proportion to the signal the other way round. Weights over the variance's integral give some
// 1e5 / 12 samples: 3 sqrt(2 / 8000) = 5 %, with the weights' own unevenness twice that.
// An autoregression of zeros filters nothing but leaves the first three samples out, 1.2e-4 of the
// weights each, of squares up to some ten times their mean.
TEST(UnevenNoise, OfJitterAndOfMultipliedNoiseIsTheClosedForm) {
  const Index n = 100000;
  const Complex pole(-6.0 / n, 0.7);
  const VectorXd record = jittered(pole, n, 0.01, 0, 0, 1);
  const auto jitter = of(record, pole);
  EXPECT_NEAR(jitter.widening(3), 4.5, 0.45);
  EXPECT_NEAR(jitter.widening(2), 1.5, 0.15);
  EXPECT_NEAR(of(record, pole, 3).widening(3), jitter.widening(3), 0.02);
  const auto multiplied = of(jittered(pole, n, 0, 0.01, 0, 2), pole);
  EXPECT_NEAR(multiplied.widening(3), 1.5, 0.15);
  EXPECT_NEAR(multiplied.widening(2), 4.5, 0.45);
}

// Of 1000 records of even noise, 2 parts each, z exceeds 3.09 in 2 by chance; squares of noise are
// skewed, which makes more of them: 20 is a hundredth.
TEST(UnevenNoise, OfEvenNoiseChangesNothing) {
  const Complex pole(-0.01, 0.7);
  int widened = 0;
  double sum = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    const VectorXd y = jittered(pole, 600, 0, 0, 0.02, seed);
    const auto white = of(y, pole);
    for (const Index k : {2, 3}) {
      widened += white.widening(k) > 1;
      sum += std::sqrt(white.widening(k));
    }
  }
  EXPECT_LE(widened, 20);
  EXPECT_NEAR(sum / 2000, 1, 0.005);
}

// 300 records of 50 Hz, damping 0.01, 1 s at 1 kHz, the clock off by 20 us in each sample: mean
// square of frequency error over standard uncertainty, to 4 sqrt(2 / 300) = 0.33. With even noise
// assumed it is 2.2. The noise at the start shows no modes: at most one record in fifty.
TEST(UnevenNoise, UncertaintiesUnderJitterAreAsStated) {
  const Complex pole = testing::pole({50, 0.01}, 1000);
  double frequency = 0, damping = 0;
  int more = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    const auto result = estimate_decay(jittered(pole, 1000, 0.02, 0, 0.001, seed + 1), 1000);
    ASSERT_FALSE(result.modes.empty());
    const DecayMode& mode = result.modes.front();
    more += result.modes.size() > 1;
    frequency += std::pow((mode.frequency_hz.value - 50) / mode.frequency_hz.std, 2);
    damping += std::pow((mode.damping_ratio.value - 0.01) / mode.damping_ratio.std, 2);
  }
  EXPECT_NEAR(frequency / 300, 1, 0.33);
  EXPECT_LT(damping / 300, 1.33);
  EXPECT_LE(more, 6);
}

}  // namespace rigfit::signal::residual_noise_test
