#include "signal/spectra/spectral_peaks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace rigfit::signal::spectral_peaks_test {
namespace {

constexpr double kRate = 50;

/// Oscillators driven by white noise, exact at the samples (a rotation of the state with its
/// stationary noise), with white noise of the sensor: nothing of the estimator's own formulas.
Eigen::VectorXd driven(const std::vector<std::pair<double, double>>& modes, Eigen::Index n,
                       std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(n, [&] { return 0.05 * normal(engine); });
  for (const auto& [frequency, damping] : modes) {
    const double w = 2 * M_PI * frequency, decay = std::exp(-damping * w / kRate);
    const std::complex<double> turn = std::polar(decay, w / kRate);
    std::complex<double> z(normal(engine), normal(engine));
    for (Eigen::Index i = 0; i < n; ++i) {
      x[i] += z.real();
      z = turn * z +
          std::sqrt(1 - decay * decay) * std::complex<double>(normal(engine), normal(engine));
    }
  }
  return x;
}

TEST(SpectralPeaks, FrequenciesOfDrivenModesWithinTheirUncertainty) {
  // 95 % of the intervals of three modes in 40 records of 10 minutes; three binomial deviations of
  // 120 are 6 %.
  const std::vector<std::pair<double, double>> modes{{1.2, 0.004}, {2.37, 0.006}, {6.1, 0.003}};
  int held = 0, all = 0;
  double ratio = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto found = spectral_peaks(driven(modes, 30000, seed), kRate, {});
    ASSERT_EQ(found.peaks.size(), modes.size()) << "seed " << seed;
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const auto& f = found.peaks[i].frequency_hz;
      held += std::abs(f.value - modes[i].first) < 1.96 * f.std;
      const double bound = std::sqrt(2 * modes[i].second * modes[i].first / (4 * M_PI * 600));
      ratio += f.std / bound;
      ++all;
    }
  }
  EXPECT_GE(held, 0.89 * all);
  EXPECT_LE(ratio / all, 1.6);  // the window costs sqrt(35/18) = 1.39, the floor a little more
}

// Rounding in the transform of a constant is no peak.
TEST(SpectralPeaks, AConstantHasNone) {
  const auto found = spectral_peaks(Eigen::VectorXd::Constant(4096, 9.81), kRate, {});
  EXPECT_TRUE(found.peaks.empty());
  EXPECT_FALSE(found.reason.empty());
}

TEST(SpectralPeaks, NoiseAloneHasNone) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    found += static_cast<int>(spectral_peaks(driven({}, 8192, seed), kRate, {}).peaks.size());
  }
  EXPECT_LE(found, 2);  // one in a hundred records
}

TEST(SpectralPeaks, ToneIsSaidToBeOne) {
  Eigen::VectorXd x = driven({{2, 0.01}}, 20000, 3);
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x[i] += 2 * std::sin(2 * M_PI * 7.77 * double(i) / kRate);
  const auto found = spectral_peaks(x, kRate, {});
  ASSERT_EQ(found.peaks.size(), 2u);
  EXPECT_FALSE(found.peaks[0].tone);
  EXPECT_TRUE(found.peaks[1].tone);
  EXPECT_NEAR(found.peaks[1].frequency_hz.value, 7.77, 3 * found.peaks[1].frequency_hz.std);
}

TEST(SpectralPeaks, RefusesWhatItCannotUse) {
  Eigen::VectorXd x = driven({}, 1000, 1);
  EXPECT_THROW((void)spectral_peaks(x.head(100), kRate, {}), std::invalid_argument);
  EXPECT_THROW((void)spectral_peaks(x, kRate, {.low_hz = 30, .high_hz = 40}),
               std::invalid_argument);
  x[5] = NAN;
  EXPECT_THROW((void)spectral_peaks(x, kRate, {}), std::invalid_argument);
}

}  // namespace
}  // namespace rigfit::signal::spectral_peaks_test
