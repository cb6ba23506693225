#include "signal/spectra/force_noise.h"

#include "signal/spectra/window.h"
#include "tests/test.h"

namespace rigfit::signal {
namespace {

constexpr Index kSamples = 4096;

/// Blocks of white noise of this standard deviation and a tone on `line`, a pulse in the middle.
struct QuietBlocks {
  std::vector<VectorXd> force;
  std::vector<FrfBlock> blocks;

  QuietBlocks(int hits, double noise, double tone, double line) {
    Normal normal(3);
    for (int i = 0; i < hits; ++i) {
      VectorXd x(kSamples);
      for (Index n = 0; n < kSamples; ++n) {
        x[n] = noise * normal() +
               tone * std::cos(2 * EIGEN_PI * line * static_cast<double>(n) / kSamples + 1.7 * i);
      }
      x.segment(300, 10).setConstant(1e3);
      force.push_back(std::move(x));
    }
    for (const VectorXd& x : force) {
      FrfBlock block{.force = {x.data(), static_cast<std::size_t>(x.size())},
                     .pulse_first = 300,
                     .pulse_last = 309};
      blocks.push_back(block);
    }
  }
};

// A tone between two lines, 44 dB over their noise: its leakage is over the noise to 20 lines away.
TEST(ForceNoise, ATonesPowerIsInTheWholeAndNotInTheBroadbandPart) {
  const QuietBlocks made(5, 0.01, 0.05, 200.37);
  const ForceNoise found = force_noise_power(made.blocks, kSamples, VectorXd::Ones(kSamples), 10);
  const double white = kSamples * 0.01 * 0.01;
  ASSERT_EQ(found.broadband.size(), kSamples / 2 + 1);
  // Means of 21 lines of 5 blocks scatter by 10 %: five of these; beside the tone lines are cut
  // at 4.9 medians.
  for (Index k = 20; k < kSamples / 2 - 20; ++k) {
    const double most = std::abs(static_cast<double>(k) - 200.37) < 30 ? 8 : 1.5;
    EXPECT_LT(found.broadband[k], most * white) << k;
    EXPECT_GT(found.broadband[k], 0.5 * white) << k;
  }
  // |sum cos exp| = A n / 2 sinc(0.37), squared.
  const double sinc = std::sin(EIGEN_PI * 0.37) / (EIGEN_PI * 0.37);
  EXPECT_NEAR(found.power[200] / std::pow(0.025 * kSamples * sinc, 2), 1, 0.05);
}

TEST(Window, ExponentialFallsToTheLevelItWasMadeFor) {
  const double rate = decay_rate_for(0.01, 2.0);
  EXPECT_DOUBLE_EQ(rate, std::log(100.0) / 2);
  const VectorXd w = exponential_window(2001, 1000, rate);
  EXPECT_EQ(w[0], 1);
  EXPECT_NEAR(w[2000], 0.01, 1e-14);
  EXPECT_THROW((void)decay_rate_for(0, 1), std::invalid_argument);
  EXPECT_THROW((void)decay_rate_for(1.5, 1), std::invalid_argument);
}

TEST(Window, ForceIsKeptAndFadedOnBothSides) {
  const VectorXd w = force_window(20, 6, 11, 3);
  EXPECT_EQ(w.segment(6, 5), VectorXd::Ones(5));
  EXPECT_NEAR(w[12], 0.5, 1e-15);  // the middle of a half cosine
  EXPECT_GT(w[11], w[12]);
  EXPECT_GT(w[13], 0);
  EXPECT_EQ(w.tail(6), VectorXd::Zero(6));
  EXPECT_NEAR(w[4], 0.5, 1e-15);
  EXPECT_EQ(w.head(3), VectorXd::Zero(3));
  EXPECT_EQ(force_window(5, 0, 5, 2), VectorXd::Ones(5));
}

}  // namespace
}  // namespace rigfit::signal
