#include "signal/decay/decay_background.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "signal/decay/decay.h"

namespace rigfit::signal::decay_background_test {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Hum of a twentieth of the amplitude, 0.2 to 0.3 Hz beside a mode that it stands alone before for
// half a second and beats with for a second, 0.3 times: 200 records at 40 dB. Mean squares of
// errors over standard uncertainties to 4 sqrt(2 / 200) = 0.4; where the tone is fitted beside a
// mode that was spent on it, or until it only creeps, that of the frequency is 1.6. The line's side
// lobes are no tones.
TEST(DecayBackground, HumBesideAModeAsLongAsItStandsAloneBefore) {
  double frequency = 0, damping = 0;
  int others = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> normal(0, 0.007);
    std::uniform_real_distribution<double> uniform;
    const double zeta = 0.002, apart = 0.2 + 0.1 * uniform(generator);
    const double f = uniform(generator) < 0.5 ? 50 - apart : 50 + apart;
    const double w = 2 * std::numbers::pi * f / 1000;
    const double phase = 2 * std::numbers::pi * uniform(generator);
    Eigen::VectorXd y(1500);
    for (Index j = 0; j < y.size(); ++j) {
      y(j) = 0.05 * std::cos(0.1 * std::numbers::pi * static_cast<double>(j) + phase) +
             normal(generator);
      const auto t = static_cast<double>(j - 500);
      if (t > 0) y(j) += std::exp(-zeta * w * t) * std::sin(w * std::sqrt(1 - zeta * zeta) * t);
    }
    const auto result = estimate_decay(y, 1000);
    ASSERT_EQ(result.modes.size(), 1U) << seed;
    const DecayMode& mode = result.modes.front();
    others += result.steady_tones.size() != 1;
    frequency += std::pow((mode.frequency_hz.value - f) / mode.frequency_hz.std, 2);
    damping += std::pow((mode.damping_ratio.value - zeta) / mode.damping_ratio.std, 2);
  }
  EXPECT_NEAR(frequency / 200, 1, 0.4);
  EXPECT_NEAR(damping / 200, 1, 0.4);
  EXPECT_LE(others, 2);
}

}  // namespace
}  // namespace rigfit::signal::decay_background_test
