#include "signal/decay/decay_steps.h"

#include "signal/decay/decay.h"
#include "tests/signal/decays.h"
#include "tests/test.h"

namespace rigfit::signal::narrow_record_test {

constexpr Index kSamples = 1 << 16;
constexpr double kRate = 1000;

/// A decay of 5.3 time constants in white noise on a line.
VectorXd record(double f, double noise) {
  std::mt19937_64 random(3);
  VectorXd y = VectorXd::LinSpaced(kSamples, 5, 5 + 1e-5 * kSamples);
  testing::add_decay(y, {f, 5.3 / kSamples * kRate / (2 * kPi * f), 2}, kRate, 0.7);
  testing::add_noise(y, noise, random);
  return y;
}

// The same stretch of the record, whole and in its band. What the two know differs by the filter's
// reach at the ends. Estimates differ by a fifth of a standard uncertainty (twice that is allowed),
// standard uncertainties by 2 % and by the scatter of the noise found, 1.6 % (three times that).
TEST(NarrowRecord, EstimatesAreThoseOfTheWholeRecord) {
  const VectorXd y = record(6, 0.3);
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

// Twice as many modes as are fitted at once, half of them above the band: these must not be what
// the fit is spent on. What is left is noise, at the samples that the result names.
TEST(NarrowRecord, ModesAboveTheBandDoNotHideThoseInIt) {
  int held = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::mt19937_64 random(seed);
    VectorXd y = VectorXd::Zero(12288);
    for (int k = 1; k <= 24; ++k) testing::add_decay(y, {7.3 * k, 0.012, 1 / std::sqrt(k)}, 2048);
    testing::add_noise(y, 0.02, random);
    DecayOptions options;
    options.choose_window = options.trim_start = false;
    options.band_low_hz = 2, options.band_high_hz = 47;
    const DecayResult found = estimate_decay(y, 2048, options);
    ASSERT_EQ(found.modes.size(), 6U);
    for (const DecayMode& mode : found.modes) {
      const auto& within = mode.damping_ratio_interval_95;
      held += within.low <= 0.012 && 0.012 <= within.high;
    }
    const Index at = found.start + 5 * found.step;
    EXPECT_NEAR(found.fitted(5) + found.residual(5), y(at), 0.2);
  }
  EXPECT_GE(held, 50);  // of 60 at 95 %: fewer by chance once in 1,000
}

// A record of a quarter of a second keeps enough samples to tell where it starts.
TEST(NarrowRecord, ShortRecordsStartWhereTheyAreStruck) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::mt19937_64 random(seed);
    VectorXd y = VectorXd::Zero(1250);
    testing::add_decay(y, {22, 0.02, 1}, 5000, 0.5, 100);
    testing::add_decay(y, {60, 0.02, 0.5}, 5000, 0.5, 100);
    testing::add_noise(y, 0.02, random);
    DecayOptions options;
    options.band_low_hz = 10, options.band_high_hz = 40;
    const DecayResult found = estimate_decay(y, 5000, options);
    EXPECT_GE(found.start, 100) << seed;
    ASSERT_FALSE(found.modes.empty()) << seed;
    EXPECT_NEAR(found.modes[0].damping_ratio.value, 0.02, 0.004) << seed;
  }
}

TEST(NarrowRecord, IsNotMadeOfGapsOrRailsOrForABandNearTheRate) {
  const VectorXd y = record(6, 0.3);
  const DecayBand band{0.003, 0.0075, false};
  const auto narrow = narrow_record(y, band);
  ASSERT_TRUE(narrow);
  EXPECT_EQ(narrow->step, 16);
  EXPECT_FALSE(narrow_record(y, {0.003, 0.07, false}));
  EXPECT_FALSE(narrow_record(y.head(128), band));  // too short
  VectorXd gap = y;
  gap(7) = kNaN;
  EXPECT_FALSE(narrow_record(gap, band));
  EXPECT_FALSE(narrow_record(y.cwiseMin(6), band));  // a rail
}

}  // namespace rigfit::signal::narrow_record_test
