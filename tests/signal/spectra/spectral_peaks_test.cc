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

// A cable in wind: in each of eight parts its frequency is another, 1 % about the mean, four times
// what one part knows it to.
TEST(SpectralPeaks, AFrequencyThatChangesHasTheUncertaintyOfItsScatter) {
  int held = 0, said = 0, silent = 0;
  constexpr int kRecords = 40;
  for (std::uint64_t seed = 1; seed <= kRecords; ++seed) {
    std::mt19937_64 engine(1000 + seed);
    std::normal_distribution<double> normal;
    Eigen::VectorXd record(8 * 6000);
    for (Eigen::Index part = 0; part < 8; ++part) {
      record.segment(6000 * part, 6000) =
          driven({{2.37 * (1 + 0.01 * normal(engine)), 0.006}}, 6000, 100 * seed + part);
    }
    const auto found = spectral_peaks(record, kRate, {});
    ASSERT_EQ(found.peaks.size(), 1U) << seed;
    const auto& f = found.peaks[0].frequency_hz;
    held += std::abs(f.value - 2.37) < 1.96 * f.std;
    said += found.peaks[0].between_parts_hz > 0;
    silent +=
        spectral_peaks(driven({{2.37, 0.006}}, 48000, seed), kRate).peaks[0].between_parts_hz > 0;
  }
  EXPECT_GE(held, 34);  // 95 % less three standard deviations (1.4 each)
  EXPECT_GE(said, 36);
  EXPECT_LE(silent, 2);
}

TEST(SpectralPeaks, NoiseAloneAndAConstantHaveNone) {
  const auto constant = spectral_peaks(Eigen::VectorXd::Constant(4096, 9.81), kRate, {});
  EXPECT_TRUE(constant.peaks.empty());
  EXPECT_FALSE(constant.reason.empty());
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    found += static_cast<int>(spectral_peaks(driven({}, 8192, seed), kRate, {}).peaks.size());
  }
  EXPECT_LE(found, 2);  // one in a hundred records
}

void add_tone(Eigen::VectorXd& x, double hz, double amplitude) {
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x[i] += amplitude * std::sin(2 * M_PI * hz * double(i) / kRate + 0.4);
}

TEST(SpectralPeaks, TonesNearAndFarFromModesAreLeftOutAndNoModeIsLost) {
  // Ten minutes, three modes; tones far from them, beside one (3 bandwidths) and on its flank. A
  // mode's frequency then is within four of its standard uncertainties in all records.
  const std::vector<std::pair<double, double>> modes{{1.2, 0.004}, {4.37, 0.003}, {9.1, 0.002}};
  int tones = 0, records = 0;
  for (std::uint64_t seed = 1; seed <= 15; ++seed, ++records) {
    auto x = driven(modes, 30000, seed);
    add_tone(x, 16.66, 0.3);
    add_tone(x, 9.1 + 3 * 2 * 0.002 * 9.1, 1.5);
    const auto found = spectral_peaks(x, kRate, {});
    ASSERT_GE(found.peaks.size(), modes.size()) << "seed " << seed;
    for (std::size_t i = 0; i < found.peaks.size(); ++i) {
      const auto& peak = found.peaks[i];
      EXPECT_EQ(peak.undecided, i >= modes.size()) << "seed " << seed;  // the tone is the last
      if (i < modes.size()) {
        EXPECT_NEAR(peak.frequency_hz.value, modes[i].first, 4 * peak.frequency_hz.std) << seed;
      }
    }
    tones += static_cast<int>(found.tones.size());
  }
  // On a mode's flank the mode's own changes can hide that a tone is steady: it then has the mark.
  EXPECT_GE(tones, 2 * records - 2);
}

TEST(SpectralPeaks, AModeOfLittleDampingIsNoTone) {
  // Damping ratios from 1e-4, where the record spans a tenth to a few of the mode's time constants:
  // at most one in a thousand is a tone, by the limit; none of these is lost.
  int peaks = 0, records = 0;
  for (const double damping : {1e-4, 3e-4, 1e-3}) {
    for (std::uint64_t seed = 1; seed <= 60; ++seed, ++records) {
      const auto found = spectral_peaks(driven({{3.3, damping}}, 6000, 100 + seed), kRate, {});
      EXPECT_TRUE(found.tones.empty()) << damping << ", seed " << seed;
      peaks += static_cast<int>(found.peaks.size());
    }
  }
  EXPECT_GE(peaks, records);
}

TEST(SpectralPeaks, AWeakToneInAShortRecordStaysWithAMark) {
  auto x = driven({}, 3000, 5);
  add_tone(x, 3.3, 0.05);
  const auto found = spectral_peaks(x, kRate, {});
  ASSERT_EQ(found.peaks.size(), 1u);
  EXPECT_TRUE(found.peaks[0].undecided);
  EXPECT_TRUE(found.tones.empty());
}

TEST(SpectralPeaks, AToneWhoseFrequencyWandersIsOne) {
  // Mains: 12.5 Hz within 0.02 Hz over ten minutes, twelve lines of the record.
  auto x = driven({{2, 0.01}}, 30000, 9);
  double phase = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double t = double(i) / kRate;
    phase += 2 * M_PI * (12.5 + 0.01 * std::sin(2 * M_PI * t / 230)) / kRate;
    x[i] += 1.5 * std::sin(phase);
  }
  const auto found = spectral_peaks(x, kRate, {});
  ASSERT_EQ(found.peaks.size(), 1u);
  EXPECT_NEAR(found.peaks[0].frequency_hz.value, 2, 0.02);
  ASSERT_GE(found.tones.size(), 1u);
  for (const auto& tone : found.tones) EXPECT_NEAR(tone.frequency_hz, 12.5, 0.03);
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
