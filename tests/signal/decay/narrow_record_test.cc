#include "signal/decay/narrow_record.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "signal/decay/decay.h"
#include "tests/signal/decays.h"

namespace rigfit::signal::narrow_record_test {
namespace {

using Eigen::Index;

constexpr Index kSamples = 1 << 16;
constexpr double kRate = 1000;
const DecayBand kAll{0, 0.5, true};

/// A decay of 5.3 time constants in white noise on a line.
Eigen::VectorXd record(double f, double noise) {
  std::mt19937_64 random(3);
  Eigen::VectorXd y = Eigen::VectorXd::LinSpaced(kSamples, 5, 5 + 1e-5 * kSamples);
  testing::add_decay(y, {f, 5.3 / kSamples * kRate / (2 * std::numbers::pi * f), 2}, kRate, 0.7);
  testing::add_noise(y, noise, random);
  return y;
}

// The same stretch of the record, whole and in its band. What the two know differs by the filter's
// reach at the ends. Estimates differ by a fifth of a standard uncertainty (twice that is allowed),
// standard uncertainties by 2 % and by the scatter of the noise found, 1.6 % (three times that).
TEST(NarrowRecord, EstimatesAreThoseOfTheWholeRecord) {
  const Eigen::VectorXd y = record(6, 0.3);
  DecayOptions options;
  options.choose_window = options.trim_start = false;
  options.band_low_hz = 3, options.band_high_hz = 7.5;
  const DecayResult narrow = estimate_decay(y, kRate, options);
  ASSERT_TRUE(testing::says(narrow.notes, "fitted_in_band"));
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
  Eigen::VectorXd y = Eigen::VectorXd::Zero(21000);
  std::mt19937_64 random(5);
  testing::add_decay(y, {12, 0.0106, 0.3}, 7000);
  for (int k = 1; k <= 12; ++k) testing::add_decay(y, {143.2 * k, 1.0 / 300}, 7000);
  testing::add_noise(y, 0.05, random);
  DecayOptions options;
  options.band_low_hz = 8, options.band_high_hz = 16;
  const auto result = estimate_decay(y, 7000, options);
  ASSERT_EQ(result.modes.size(), 1U) << result.refusal;
  testing::expect_mode(result.modes[0], 12, 0.0106, 4);
}

TEST(NarrowRecord, LongRecordsGoDownToWhatStandsOut) {
  const Eigen::VectorXd y = record(6, 0.3);
  const auto narrow = narrow_record(y, kAll, kSamples);
  ASSERT_TRUE(narrow);
  EXPECT_EQ(narrow->step, 4);  // a quarter of the samples is left
  EXPECT_FALSE(narrow_record(record(214, 0.3), kAll, kSamples));
  EXPECT_FALSE(narrow_record(y - record(6, 0), kAll, kSamples));  // nothing stands out
  EXPECT_FALSE(narrow_record(y, kAll));                           // not long
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
