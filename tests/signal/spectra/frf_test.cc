#include "signal/spectra/frf.h"

#include "tests/test.h"

namespace rigfit::signal::frf_test {

std::span<const double> view(const VectorXd& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}

/// Hits through a pure gain, with white noise on either side: H is known to be that gain. Peaks lie
/// within `spread` of 1; the response's noise is the same in all hits or goes with them.
struct GainTest {
  GainTest(Index n, int hits, double gain, double force_noise, double response_noise,
           std::mt19937_64& random, double spread = 0.3, bool with_hit = false) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(1 - spread, 1 + spread);
    for (int i = 0; i < hits; ++i) {
      const double peak = uniform(random), noise = response_noise * (with_hit ? peak : 1);
      VectorXd force = VectorXd::Zero(n);
      force[2] = peak, force[3] = 0.5 * peak;
      VectorXd response = gain * force;
      for (Index k = 0; k < n; ++k) {
        force[k] += force_noise * normal(random);
        response[k] += noise * normal(random);
      }
      forces.push_back(force);
      responses.push_back(response);
    }
    for (int i = 0; i < hits; ++i) {
      FrfBlock block{.force = view(forces[i]),
                     .responses = {view(responses[i])},
                     .pulse_first = 2,
                     .pulse_last = 3,
                     .response_noise_std = {response_noise}};
      blocks.push_back(block);
    }
  }
  std::vector<VectorXd> forces, responses;
  std::vector<FrfBlock> blocks;
};

FrfOptions options_for(Index n) { return {.sample_rate_hz = 1000, .block_samples = n}; }

// The mean of H_std^2 against the mean square error of Re H and of Im H, over trials and lines.
// Each ratio averages trials * lines = 62,000 squared Gaussians: its own standard deviation is
// sqrt(2 / 62000) = 0.6 %, that of the mean variance estimate sqrt(1 / (62000 (n - 1))); 2 % is
// three of them. Bendat and Piersol's n for n - 1 would be off by 50 % at n = 3 and 11 % at n = 10.
TEST(Frf, ErrorBarsAreTheScatterOfTheAverage) {
  constexpr Index kSamples = 64;
  constexpr double kGain = 2;
  std::mt19937_64 random(7);
  for (const int hits : {2, 3, 5, 10}) {
    double real = 0, imaginary = 0, stated = 0;
    for (int trial = 0; trial < 2000; ++trial) {
      const GainTest test(kSamples, hits, kGain, 0, 0.05, random);
      const FrfEstimate estimate = average_frfs(test.blocks, options_for(kSamples));
      const Index lines = estimate.H.rows() - 2;  // 0 Hz and half the rate are real
      real += (estimate.H.col(0).segment(1, lines).real().array() - kGain).square().sum();
      imaginary += estimate.H.col(0).segment(1, lines).imag().squaredNorm();
      stated += estimate.H_std.col(0).segment(1, lines).squaredNorm();
    }
    EXPECT_NEAR(real / stated, 1, 0.02) << hits;
    EXPECT_NEAR(imaginary / stated, 1, 0.02) << hits;
  }
}

// Noise that goes with the hit, peaks between 0.3 and 1.7: E X^4 / (E X^2)^2 = 1.5 times the
// variance that one noise for all hits would give. With weights of 1 / (1 - leverage) ten hits are
// within a tenth of the truth.
TEST(Frf, ErrorBarsHoldWhereNoiseGoesWithTheHit) {
  constexpr Index kSamples = 64, kLines = kSamples / 2 - 1;
  std::mt19937_64 random(8);
  double error = 0, stated = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const GainTest test(kSamples, 10, 2, 0, 0.05, random, 0.7, true);
    const FrfEstimate estimate = average_frfs(test.blocks, options_for(kSamples));
    error += (estimate.H.col(0).segment(1, kLines).array() - 2.0).abs2().sum() / 2;
    stated += estimate.H_std.col(0).segment(1, kLines).squaredNorm();
  }
  EXPECT_NEAR(error / stated, 1, 0.1);
}

// Noise of s^2 per line over signal of S per hit biases H1 by 1 / (1 + s^2 n / (S n)) where it is
// on the force, H2 by 1 + that where it is on the response; the other is unbiased, Hv in between.
TEST(Frf, EstimatorsAreBiasedWhereTheoryPutsIt) {
  constexpr Index kSamples = 64;
  std::mt19937_64 random(5);
  const auto mean_of = [&](FrfEstimator estimator, double force_noise, double response_noise,
                           bool noise_known = false) {
    FrfOptions options = options_for(kSamples);
    options.estimator = estimator;
    double sum = 0;
    constexpr int kTrials = 100;
    for (int trial = 0; trial < kTrials; ++trial) {
      GainTest test(kSamples, 100, 2, force_noise, response_noise, random);
      for (FrfBlock& block : test.blocks) block.pulse_last = noise_known ? 3 : -1;
      sum += average_frfs(test.blocks, options).H(4, 0).real() / kTrials;
    }
    return sum;
  };
  // Line 4 of 64: |1 + 0.5 exp(-i 2 pi 4 / 64)|^2 = 2.174, mean square peak 1.03.
  const double power = 2.174 * 1.03;
  const double force_share = 64 * 0.05 * 0.05 / power, response_share = 64 * 0.1 * 0.1 / power / 4;
  // 100 trials of 100 hits: noise of 2 sqrt(0.07 / 1e4) = 0.005; terms of 2 * 0.07 / 100 left out.
  EXPECT_NEAR(mean_of(FrfEstimator::h1, 0.05, 0), 2 / (1 + force_share), 0.012);
  // The noise measured beside the pulse takes that off.
  EXPECT_NEAR(mean_of(FrfEstimator::h1, 0.05, 0, true), 2, 0.012);
  EXPECT_NEAR(mean_of(FrfEstimator::h2, 0.05, 0), 2, 0.012);
  EXPECT_NEAR(mean_of(FrfEstimator::h1, 0, 0.1), 2, 0.012);
  EXPECT_NEAR(mean_of(FrfEstimator::h2, 0, 0.1), 2 * (1 + response_share), 0.012);
  EXPECT_NEAR(mean_of(FrfEstimator::hv, 0.05, 0), 2 / std::sqrt(1 + force_share), 0.012);
}

TEST(Frf, NothingGivesZeroAndNeverNan) {
  const VectorXd zero = VectorXd::Zero(32);
  const std::vector<FrfBlock> blocks(3,
                                     {.force = view(zero), .responses = {view(zero), view(zero)}});
  FrfOptions options = options_for(32);
  for (const auto estimator : {FrfEstimator::h1, FrfEstimator::h2, FrfEstimator::hv}) {
    options.estimator = estimator;
    const FrfEstimate estimate = average_frfs(blocks, options);
    EXPECT_EQ(estimate.H.cwiseAbs().maxCoeff(), 0);
    EXPECT_TRUE(estimate.H_std.allFinite());
    EXPECT_TRUE(estimate.coherence.allFinite());
    EXPECT_TRUE(estimate.incoherence_without.allFinite());
  }
}

}  // namespace rigfit::signal::frf_test
