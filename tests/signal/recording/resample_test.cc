// Resampling keeps what lies below the new rate's band, removes what would fold, and states an
// error that the true one stays below.
#include "signal/recording/resample.h"

#include "signal/recording/recording.h"
#include "tests/test.h"

namespace rigfit::signal::resample_test {

double wave(double t, double f) { return std::sin(2 * kPi * f * t + 0.3); }

Recording record(const VectorXd& t, double rate, double f) {
  return {
      .sample_rate_hz = rate,
      .channels = {{.name = "a", .samples = t.unaryExpr([f](double x) { return wave(x, f); })}}};
}

/// rms departure from the wave, away from the ends.
double error_of(const Recording& recording, double f) {
  const auto& x = recording.channels[0].samples;
  const Index n = x.size(), end = n / 5;
  double sum = 0;
  for (Index k = end; k < n - end; ++k) {
    const double t = recording.start_time_s + static_cast<double>(k) / recording.sample_rate_hz;
    sum += std::pow(x[k] - wave(t, f), 2);
  }
  return std::sqrt(sum / static_cast<double>(n - 2 * end));
}

TEST(Resample, DecimationKeepsTheBandAndRemovesWhatWouldFold) {
  const VectorXd t = VectorXd::LinSpaced(8000, 0, 7999) / 4000;
  for (const double rate : {1000.0, 730.0}) {
    const auto kept = resampled(record(t, 4000, 0.35 * rate), rate);
    EXPECT_LT(error_of(kept.recording, 0.35 * rate), 1e-4);  // the filter's 80 dB
    EXPECT_LT(error_of(kept.recording, 0.35 * rate), 2 * kept.channels[0].error_rms + 1e-5);
    const auto folded = resampled(record(t, 4000, 0.7 * rate), rate);
    const auto& x = folded.recording.channels[0].samples;
    EXPECT_LT(x.segment(x.size() / 5, x.size() / 2).cwiseAbs().maxCoeff(), 2e-4);
  }
}

TEST(Resample, UnevenTimesAreMadeEvenWithAnErrorThatHolds) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> jitter(-0.3, 0.3);
  VectorXd t(2000);
  for (int k = 0; k < 2000; ++k) t[k] = (k + jitter(random)) / 500;
  Recording uneven = record(t, 500, 20);
  uneven.time_s = t;
  const auto even = resampled(uneven, 0);
  EXPECT_EQ(even.recording.time_s.size(), 0);
  EXPECT_NEAR(even.recording.sample_rate_hz, 500, 25);
  EXPECT_LT(error_of(even.recording, 20), even.channels[0].error_rms);
  EXPECT_LT(even.channels[0].error_rms, 0.02);
}

TEST(PlacedEvenly, KeepsValuesAndTheirOwnTimes) {
  const VectorXd t{{2, 2.012, 2.018, 2.041}};
  Recording uneven = record(t, 100, 3);
  EXPECT_FALSE(placed_evenly(uneven));
  uneven.time_s = t;
  const auto placed = placed_evenly(uneven).value();
  const VectorXd &x = placed.channels[0].samples, &given = uneven.channels[0].samples;
  ASSERT_EQ(x.size(), 5);
  EXPECT_EQ(placed.time_s.size(), 0);
  for (const auto& [from, to, late] :
       {std::tuple{0, 0, 0.0}, {1, 1, 0.2}, {2, 2, -0.2}, {3, 4, 0.1}}) {
    EXPECT_EQ(x[to], given[from]);
    EXPECT_NEAR(placed.late[to], late, 1e-9);
  }
  EXPECT_TRUE(std::isnan(x[3]));
  uneven.time_s[2] = 2.0125;  // two at one place
  EXPECT_FALSE(placed_evenly(uneven));
}

TEST(Resample, GapsAndMissingOrClippedSamplesAreNotFilledIn) {
  VectorXd t(100);
  for (int k = 0; k < 100; ++k) t[k] = 0.01 * k + (k < 50 ? 0 : 0.2) + (k % 7 == 0 ? 1e-3 : 0);
  Recording uneven = record(t, 100, 3);
  uneven.time_s = t;
  EXPECT_THROW((void)resampled(uneven, 100), RecordingError);
  Recording even = record(t, 100, 3);
  EXPECT_NO_THROW((void)resampled(even, 50));
  auto& x = even.channels[0].samples;
  x = x.cwiseMin(0.8);
  EXPECT_THROW((void)resampled(even, 50), RecordingError);
  x[4] = kNaN;
  EXPECT_THROW((void)resampled(even, 50), RecordingError);
}

TEST(Resample, ARateThatLeavesNoSamplesIsRefused) {
  const Recording even = record(VectorXd::LinSpaced(100, 0, 0.99), 100, 3);
  EXPECT_THROW((void)resampled(even, 5), RecordingError);
  EXPECT_THROW((void)resampled(even, 1e-320), RecordingError);
  EXPECT_EQ(resampled(even, 10).recording.samples(), 10);
}

}  // namespace rigfit::signal::resample_test
