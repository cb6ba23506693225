#include "signal/decay/narrow_record.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>

#include "signal/decay/decay.h"

namespace rigfit::signal::narrow_record_test {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr Index kSamples = 1 << 16;
constexpr double kRate = 1000;

NarrowOptions small() {
  NarrowOptions options;
  options.least_samples = kSamples, options.samples_left = kSamples / 32, options.block = 2048;
  return options;
}

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

bool says(const DecayResult& result, const char* code) {
  return std::any_of(result.notes.begin(), result.notes.end(),
                     [&](const Note& note) { return note.code == code; });
}

const DecayBand kAll{0, 0.5, true};

// The same stretch of the record, whole and in its band. What the two know differs by the filter's
// reach at the ends, some 4 of 1952 narrow samples on either side: at the first ones, where
// the mode is largest, 4 % of its energy. Estimates differ by its root, a fifth of a standard
// uncertainty (twice that is allowed), standard uncertainties by 2 % and by the scatter of the
// noise found, 1.6 % (three times that).
TEST(NarrowRecord, EstimatesAreThoseOfTheWholeRecord) {
  for (const double hz : {4.0, 50.0, 214.0, 443.0}) {
    const Eigen::VectorXd y = record(hz, 0.3, 3);
    const auto narrow = narrow_record(y, kAll, small());
    ASSERT_TRUE(narrow) << hz;
    EXPECT_EQ(narrow->step, 32) << hz;
    EXPECT_EQ(narrow->shift_line == 0, hz < 10) << hz;
    const Index last = narrow->record_sample(narrow->samples.size() - 1);
    const Eigen::VectorXd same = y.segment(narrow->first, last + 1 - narrow->first);
    DecayResult whole = estimate_decay(same, kRate);
    whole.start += narrow->first;
    const DecayResult band = estimate_narrow_decay(*narrow, kRate, {});
    ASSERT_EQ(whole.modes.size(), 1U) << hz;
    ASSERT_EQ(band.modes.size(), 1U) << hz;
    EXPECT_TRUE(says(band, "fitted_in_band"));
    const DecayMode &w = whole.modes[0], &b = band.modes[0];
    EXPECT_NEAR(b.frequency_hz.value, w.frequency_hz.value, 0.4 * w.frequency_hz.std) << hz;
    EXPECT_NEAR(b.damping_ratio.value, w.damping_ratio.value, 0.4 * w.damping_ratio.std) << hz;
    EXPECT_NEAR(b.frequency_hz.std, w.frequency_hz.std, 0.05 * w.frequency_hz.std) << hz;
    EXPECT_NEAR(b.damping_ratio.std, w.damping_ratio.std, 0.05 * w.damping_ratio.std) << hz;
    EXPECT_NEAR(band.noise_std, whole.noise_std, 0.05 * whole.noise_std) << hz;
    EXPECT_NEAR(band.signal_to_noise_db, whole.signal_to_noise_db, 0.3) << hz;
    EXPECT_NEAR(b.cycles, w.cycles, 0.001 * w.cycles) << hz;
    // At the start of either fit: both taken to sample 0.
    const auto at_zero = [&](const DecayResult& result) {
      const DecayMode& m = result.modes[0];
      const double t = static_cast<double>(result.start) / kRate;
      return std::polar(m.amplitude, m.phase_rad) *
             std::exp(Complex(2 * std::numbers::pi * m.damping_ratio.value * m.frequency_hz.value,
                              -2 * std::numbers::pi * m.damped_frequency_hz.value) *
                      t);
    };
    EXPECT_LT(std::abs(at_zero(band) - at_zero(whole)), 0.02) << hz;
    const double offset = band.offset - 1e-5 * static_cast<double>(band.start);
    EXPECT_NEAR(offset, 5, 0.02) << hz;
    EXPECT_NEAR(band.drift_per_s, 1e-2, 5e-4) << hz;
    EXPECT_NEAR(b.damping_ratio_log_decrement.value, b.damping_ratio.value,
                0.1 * b.damping_ratio.value)
        << hz;
    ASSERT_FALSE(band.envelope.points.empty()) << hz;
    EXPECT_NEAR(band.envelope.points[0].frequency_hz.value, hz,
                6 * band.envelope.points[0].frequency_hz.std)
        << hz;
  }
}

// Variance and neighbours' products of white noise: 2000 samples scatter by 3 and 2 %.
TEST(NarrowRecord, WhiteNoiseStaysWhite) {
  const Eigen::VectorXd y = record(214, 0.3, 5);
  Eigen::VectorXd tone = record(214, 0, 5);
  const auto with = narrow_record(y, kAll, small());
  ASSERT_TRUE(with);
  // The same filter on the tone alone, given some noise far away from it: by linearity.
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal(0, 0.3);
  Eigen::VectorXd noise(kSamples);
  for (double& value : noise) value = normal(random);
  const auto other = narrow_record(tone + noise, kAll, small());
  ASSERT_TRUE(other);
  ASSERT_EQ(other->shift_line, with->shift_line);
  // Difference between two noises.
  const Eigen::VectorXd difference = with->samples - other->samples;
  const auto n = static_cast<double>(difference.size());
  const double variance = difference.squaredNorm() / n;
  EXPECT_NEAR(variance * static_cast<double>(with->step), 2 * 0.09, 0.18 * 0.13);
  for (const Index lag : {1, 2, 3, 5, 8}) {
    const double product =
        difference.head(difference.size() - lag).dot(difference.tail(difference.size() - lag)) / n;
    EXPECT_LT(std::abs(product / variance), 0.09) << lag;
  }
}

TEST(NarrowRecord, LeavesAloneWhatItCannotHold) {
  const Eigen::VectorXd y = record(214, 0.3, 7);
  EXPECT_FALSE(narrow_record(y.head(kSamples - 1), kAll, small()));  // short
  Eigen::VectorXd gap = y;
  gap(1000) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(narrow_record(gap, kAll, small()));
  EXPECT_FALSE(narrow_record(y.cwiseMin(1.5 + 5), kAll, small()));               // rails
  EXPECT_FALSE(narrow_record(y + record(20, 0, 7), kAll, small()));              // too far apart
  EXPECT_FALSE(narrow_record(record(214, 0, 7), kAll, small()));                 // no noise
  EXPECT_FALSE(narrow_record(y - record(214, 0, 7), kAll, small()));             // nothing else
  EXPECT_TRUE(narrow_record(y + record(20, 0, 7), {0.1, 0.5, false}, small()));  // asked for one
  // A short motion elsewhere in the spectrum, 30 samples long.
  Eigen::VectorXd knock = y;
  for (Index j = 0; j < 400; ++j) {
    const auto t = static_cast<double>(j);
    knock(20000 + j) += 20 * std::exp(-t / 30) * std::cos(0.3 * t);
  }
  EXPECT_FALSE(narrow_record(knock, kAll, small()));
}

// A record of more than 2^22 samples goes this way by itself.
TEST(NarrowRecord, LongRecordsAreFittedInTheirBand) {
  const Eigen::VectorXd y = record(214, 0.3, 9, (1 << 22) + 1000);
  const DecayResult result = estimate_decay(y, kRate);
  ASSERT_EQ(result.modes.size(), 1U);
  EXPECT_TRUE(says(result, "fitted_in_band"));
  EXPECT_EQ(result.residual.size(), 0);
  EXPECT_LE(result.end, y.size());
  EXPECT_GT(result.end - result.start, y.size() - 2000);
  const DecayMode& mode = result.modes[0];
  EXPECT_NEAR(mode.frequency_hz.value, 214, 4 * mode.frequency_hz.std);
  const double decay_rate = 5.3 / static_cast<double>(y.size()) * kRate;
  EXPECT_NEAR(mode.damping_ratio.value, decay_rate / (2 * std::numbers::pi * 214),
              4 * mode.damping_ratio.std);
}

}  // namespace
}  // namespace rigfit::signal::narrow_record_test
