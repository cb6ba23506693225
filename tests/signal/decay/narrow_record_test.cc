#include "signal/decay/narrow_record.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>

#include "signal/decay/decay.h"
#include "tests/findings.h"

namespace rigfit::signal::narrow_record_test {
namespace {
using rigfit::testing::says;

using Complex = std::complex<double>;
using Eigen::Index;

constexpr Index kSamples = 1 << 16;
constexpr double kRate = 1000;
const DecayBand kAll{0, 0.5, true};

/// A decay of 5.3 time constants in white noise on a line.
Eigen::VectorXd record(double frequency_hz, double noise, unsigned seed, Index samples = kSamples) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, noise);
  const Complex pole(-5.3 / static_cast<double>(samples),
                     2 * std::numbers::pi * frequency_hz / kRate);
  Eigen::VectorXd y(samples);
  for (Index j = 0; j < samples; ++j) {
    const auto t = static_cast<double>(j);
    y(j) = 2 * std::exp(pole * t + Complex(0, 0.7)).real() + 5 + 1e-5 * t + normal(random);
  }
  return y;
}

// The same stretch of the record, whole and in its band. What the two know differs by the filter's
// reach at the ends. Estimates differ by a fifth of a standard uncertainty (twice that is allowed),
// standard uncertainties by 2 % and by the scatter of the noise found, 1.6 % (three times that).
TEST(NarrowRecord, EstimatesAreThoseOfTheWholeRecord) {
  const Eigen::VectorXd y = record(6, 0.3, 3);
  DecayOptions options;
  options.choose_window = options.trim_start = false;
  options.band_low_hz = 3, options.band_high_hz = 7.5;
  const DecayResult narrow = estimate_decay(y, kRate, options);
  ASSERT_TRUE(says(narrow.notes, "fitted_in_band"));
  options.band_low_hz = options.band_high_hz = 0;
  const DecayResult whole =
      estimate_decay(y.segment(narrow.start, narrow.end - narrow.start), kRate, options);
  ASSERT_EQ(narrow.modes.size(), 1U);
  ASSERT_EQ(whole.modes.size(), 1U);
  const DecayMode &a = narrow.modes[0], &b = whole.modes[0];
  EXPECT_NEAR(a.frequency_hz.value, b.frequency_hz.value, 0.4 * b.frequency_hz.std);
  EXPECT_NEAR(a.damping_ratio.value, b.damping_ratio.value, 0.4 * b.damping_ratio.std);
  EXPECT_NEAR(a.frequency_hz.std / b.frequency_hz.std, 1, 0.08);
  EXPECT_NEAR(a.damping_ratio.std / b.damping_ratio.std, 1, 0.08);
  EXPECT_NEAR(a.amplitude / b.amplitude, 1, 0.02);
  EXPECT_NEAR(a.energy / b.energy, 1, 0.02);
  EXPECT_NEAR(narrow.noise_std / whole.noise_std, 1, 0.1);
  EXPECT_NEAR(narrow.signal_to_noise_db, whole.signal_to_noise_db, 0.5);
}

// 12 Hz beside louder modes far above, at 7 kHz.
TEST(NarrowRecord, ABandAtAHighRateFindsItsMode) {
  Eigen::VectorXd y(21000);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0, 0.05);
  for (Index j = 0; j < y.size(); ++j) {
    const double t = static_cast<double>(j) / 7000;
    y(j) = 0.3 * std::exp(-0.8 * t) * std::cos(75.4 * t) + normal(random);
    for (int k = 1; k <= 12; ++k) y(j) += std::exp(-3.0 * k * t) * std::cos(900.0 * k * t);
  }
  DecayOptions options;
  options.band_low_hz = 8, options.band_high_hz = 16;
  const auto result = estimate_decay(y, 7000, options);
  ASSERT_TRUE(result.refusal.empty()) << result.refusal;
  ASSERT_EQ(result.modes.size(), 1U);
  const auto& mode = result.modes[0];
  EXPECT_NEAR(mode.frequency_hz.value, std::hypot(75.4, 0.8) / (2 * std::numbers::pi),
              4 * mode.frequency_hz.std);
  EXPECT_NEAR(mode.damping_ratio.value, 0.8 / std::hypot(75.4, 0.8), 4 * mode.damping_ratio.std);
}

TEST(NarrowRecord, LongRecordsGoDownToWhatStandsOut) {
  const Eigen::VectorXd y = record(6, 0.3, 3);
  const auto narrow = narrow_record(y, kAll, kSamples);
  ASSERT_TRUE(narrow);
  EXPECT_EQ(narrow->step, 4);  // a quarter of the samples is left
  EXPECT_FALSE(narrow_record(record(214, 0.3, 3), kAll, kSamples));
  EXPECT_FALSE(narrow_record(y - record(6, 0, 3), kAll, kSamples));  // nothing stands out
  EXPECT_FALSE(narrow_record(y, kAll));                              // not long
  // A knock between two blocks' middles is seen as well.
  Eigen::VectorXd knock = y;
  for (Index j = 0; j < 300; ++j) knock(33000 + j) += 40 * std::sin(1.9 * static_cast<double>(j));
  EXPECT_FALSE(narrow_record(knock, kAll, kSamples));
  Eigen::VectorXd gap = y;
  gap(7) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(narrow_record(gap, kAll, kSamples));
  EXPECT_FALSE(narrow_record(y.cwiseMin(6), kAll, kSamples));  // a rail
}

}  // namespace
}  // namespace rigfit::signal::narrow_record_test
