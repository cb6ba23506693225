#include "signal/impact/impact_frfs.h"

#include "signal/recording/recording.h"
#include "signal/spectra/frf_checks.h"
#include "tests/reference/ten_mode_truth.h"
#include "tests/test.h"

namespace rigfit::signal::impact_test_test {

using testing::ImpactRecordOptions;

std::vector<std::string> names(Index count) {
  std::vector<std::string> result;
  for (Index j = 0; j < count; ++j) result.push_back("#" + std::to_string(j + 2));
  return result;
}

ImpactTest analyse(const Recording& recording, Index responses, const ImpactTestOptions& options) {
  const auto all = names(responses);
  return analyse_impact_test(std::span(&recording, 1), "force", all, options);
}

/// Largest over the responses of |H - exact| / |exact|, rms over lines below 1300 Hz.
double error_of(const FrfSet& frfs, const MatrixXcd& exact) {
  double worst = 0;
  for (Index c = 0; c < exact.cols(); ++c) {
    worst = std::max(
        worst, (frfs.H.col(c).head(exact.rows()) - exact.col(c)).norm() / exact.col(c).norm());
  }
  return worst;
}

VectorXd lines_below(const FrfSet& frfs, double f) {
  return frfs.frequency_hz.head((frfs.frequency_hz.array() < f).count());
}

// Without noise what is left of the error is what aliases (5e-6 past its low-pass) and what
// each ring-down leaves beyond its block: exp(-(1.57 + a) 4 s) of the 25 Hz mode.
TEST(ImpactTest, GivesTheExactFrfAlsoUnderAnExponentialWindow) {
  const auto truth = testing::ten_mode_truth(6);
  const Recording recording = testing::impact_recording(truth, {.noise = 0});
  for (const double rate : {0.0, 2.0}) {
    for (const double force_window : {0.0, 0.02}) {
      ImpactTestOptions options{.exponential_decay_rate_1_s = rate};
      options.force_window_s = force_window;
      const ImpactTest test = analyse(recording, 6, options);
      EXPECT_EQ(test.frfs.averages, 5);
      EXPECT_EQ(test.frfs.exponential_decay_rate_1_s, rate);
      EXPECT_EQ(test.frfs.form, FrfForm::accelerance);
      EXPECT_TRUE(test.amplitudes);
      const double error =
          error_of(test.frfs, truth.accelerance(lines_below(test.frfs, 1300), rate));
      EXPECT_LT(error, rate > 0 ? 2e-5 : 2.5e-3) << rate << " " << force_window;
      const auto check =
          check_driving_point(test.frfs, truth.driving_point, 0, std::pair(0.0, test.usable_hz));
      EXPECT_EQ(check.verdict, DrivingPointVerdict::consistent);
      EXPECT_LT(check.wrong_sign_share, 1e-3);
    }
  }
}

// Errors over their error bars, real and imaginary parts, lines to 1200 Hz, n hits, noise on all
// channels; damped so that nothing rings on into the next hit (4.7 1/s over 2 s: 8e-5). The mean
// square of Gaussian errors with correct error bars is one; error bars with f = 42 (n - 1) degrees
// of freedom make it 1 + 2 / f, or 1.024 at n = 3. The noise on the force is common to the
// responses, the window's noise bandwidth is 2.5 Hz: 480 lines x 2 parts x 8 seeds scatter by
// sqrt(2 / 7680) = 1.6 %, three of which with the 2.4 % are 7 %. Coverage of 1.96 std: 0.05, with
// the same number 0.01.
TEST(ImpactTest, ErrorBarsAreRightOnTheTenModes) {
  auto truth = testing::ten_mode_truth(6);
  truth.damping_ratio[0] = 0.03;
  truth.damping_ratio[1] = 0.012;
  ImpactRecordOptions record{.block_samples = 16384};
  for (const int hits : {3, 6, 10}) {
    double square = 0, count = 0, outside = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      record.seed = seed;
      record.hits = hits;
      const ImpactTest test =
          analyse(testing::impact_recording(truth, record), 6, {.exponential_decay_rate_1_s = 5});
      ASSERT_EQ(test.frfs.averages, hits);
      const VectorXd f = lines_below(test.frfs, 1200);
      const MatrixXcd exact = truth.accelerance(f, 5);
      for (Index c = 0; c < 6; ++c) {
        for (Index k = 2; k < f.size(); ++k, count += 2) {
          const Complex z = (test.frfs.H(k, c) - exact(k, c)) / test.frfs.H_std(k, c);
          square += std::norm(z);
          outside += (std::abs(z.real()) > 1.96 ? 1 : 0) + (std::abs(z.imag()) > 1.96 ? 1 : 0);
        }
      }
    }
    EXPECT_NEAR(square / count, 1, 0.07) << hits;
    EXPECT_NEAR(outside / count, 0.05, 0.01) << hits;
  }
}

TEST(ImpactTest, AKnockDuringOneRingDownIsAnOutlierAndCleanHitsAreNot) {
  const auto truth = testing::ten_mode_truth(4);
  ImpactRecordOptions record{.block_samples = 8192};
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    record.seed = seed;
    Recording recording = testing::impact_recording(truth, record);
    EXPECT_EQ(analyse(recording, 4, {}).frfs.averages, 5) << seed;
    // Something else strikes the structure 0.2 s after the third hit, a tenth as hard; the hammer's
    // force does not know of it.
    const auto hits = testing::hammer_hits(record);
    ImpactRecordOptions quiet = record;
    quiet.noise = 0;
    const Recording knock =
        testing::impact_recording(truth, {{hits[2].time_s + 0.2, 0.1 * hits[2].peak, 1e-3}}, quiet,
                                  static_cast<double>(recording.samples()) / record.sample_rate_hz);
    for (std::size_t c = 1; c < recording.channels.size(); ++c) {
      recording.channels[c].samples += knock.channels[c].samples;
    }
    const ImpactTest test = analyse(recording, 4, {});
    EXPECT_EQ(test.frfs.averages, 4) << seed;
    EXPECT_THAT(test.search.hits[2].faults, ElementsAre(HitFault::outlier));
    EXPECT_THAT(test.search.hits[2].reason, HasSubstr("outlier: without it"));
  }
}

// A soft hammer drives lines to 200 Hz; above there is noise only, which is none of the hit's.
TEST(ImpactTest, ASpoiltHitOfASoftHammerIsAnOutlier) {
  const auto truth = testing::ten_mode_truth(4);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const ImpactRecordOptions record{.block_samples = 16384, .noise = 0.05, .seed = seed};
    auto hits = testing::hammer_hits(record);
    for (auto& hit : hits) hit.duration_s = 8e-3;
    Recording recording = testing::impact_recording(truth, hits, record);
    const auto from = static_cast<Index>((hits[2].time_s - 0.05) * record.sample_rate_hz);
    for (std::size_t c = 1; c < recording.channels.size(); ++c) {
      recording.channels[c].samples.segment(from, record.block_samples) *= 1.3;
    }
    const ImpactTest test = analyse(recording, 4, {});
    EXPECT_EQ(test.frfs.averages, 4) << seed;
    EXPECT_THAT(test.search.hits[2].faults, ElementsAre(HitFault::outlier)) << seed;
  }
}

TEST(ImpactTest, SaysWhatCannotBeTrusted) {
  const auto truth = testing::ten_mode_truth(2);
  ImpactRecordOptions record;
  record.block_samples = 4096;  // 0.5 s: the 25 Hz mode is at 45 %
  Recording recording = testing::impact_recording(truth, record);
  EXPECT_TRUE(says(analyse(recording, 2, {}).notes, "ring_down_truncated"));
  recording.channels[0].unit = "V";
  const ImpactTest volts = analyse(recording, 2, {});
  EXPECT_EQ(volts.frfs.form, FrfForm::unknown);
  EXPECT_EQ(volts.frfs.unit, "(m/s^2)/V");
  EXPECT_TRUE(says(volts.notes, "frf_form"));
  recording.channels[0].unit = "N";
  recording.channels[2].unit = "m/s";
  const ImpactTest mixed = analyse(recording, 2, {});
  EXPECT_EQ(mixed.frfs.form, FrfForm::accelerance);
  EXPECT_TRUE(says(mixed.notes, "frf_form"));
  std::vector<Recording> two{recording, recording};
  std::swap(two[1].channels[0], two[1].channels[2]);
  EXPECT_THROW((void)analyse_impact_test(two, "force", names(1)), RecordingError);
  recording.channels[2].samples.setConstant(1);
  EXPECT_TRUE(says(analyse(recording, 2, {}).notes, "dead_frf"));
}

// A hammer that goes on to swing is cut off by the window, a quiet one is not.
TEST(ImpactTest, AForceThatGoesOnBehindItsWindowIsSaid) {
  const ImpactRecordOptions options;
  const auto hits = testing::hammer_hits(options);
  Recording recording = testing::impact_recording(testing::ten_mode_truth(2), hits, options);
  EXPECT_FALSE(says(analyse(recording, 2, {}).notes, "force_window"));
  auto& force = recording.channels[0].samples;
  for (const auto& hit : hits) {
    for (Index k = 0; k < force.size(); ++k) {
      const double t = static_cast<double>(k) / recording.sample_rate_hz - hit.time_s;
      if (t > 1e-3) force[k] += 0.03 * hit.peak * std::exp(-100 * t) * std::sin(2500 * t);
    }
  }
  EXPECT_TRUE(says(analyse(recording, 2, {}).notes, "force_window"));
}

// Noise of 1 % of the peak over the whole block has a third of the force's power, noise of 0.02 % a
// ten thousandth, which still makes errors of 1 % in single lines: the window keeps both out, and
// what is left is subtracted from Gxx.
TEST(ImpactTest, ForceNoiseIsMeasuredKeptOutAndSubtracted) {
  const auto truth = testing::ten_mode_truth(2);
  const Recording clean = testing::impact_recording(truth, {.noise = 0});
  ImpactTestOptions options{.exponential_decay_rate_1_s = 2};
  options.hits.double_hit = 0.06;  // noise of this size hides 5 %
  ImpactTest raw;
  MatrixXcd exact;
  for (const double noise : {2e-4, 0.01}) {
    Recording recording = clean;
    std::mt19937_64 random(4);
    std::normal_distribution<double> normal(0, noise * clean.channels[0].samples.maxCoeff());
    for (double& x : recording.channels[0].samples) x += normal(random);
    options.force_window_s.reset();
    const ImpactTest windowed = analyse(recording, 2, options);
    EXPECT_GT(windowed.force_window_s, 1.5e-3);
    EXPECT_FALSE(says(windowed.notes, "force_noise"));
    options.force_window_s = 0;
    raw = analyse(recording, 2, options);
    EXPECT_EQ(says(raw.notes, "force_noise"), noise > 1e-3);
    exact = truth.accelerance(lines_below(raw.frfs, 1300), 2);
    EXPECT_LT(windowed.force_noise_left, 0.05 * raw.force_noise_left);
    EXPECT_LT(error_of(windowed.frfs, exact), 0.25 * error_of(raw.frfs, exact)) << noise;
  }
  // Mean of H over the exact one: free of bias within its scatter. 3000 lines, each uncertain by
  // sqrt(0.3 / 10) and more where the force is weak, neighbours under the window alike: 1 %.
  double mean = 0;
  for (Index k = 100; k < exact.rows(); ++k) mean += (raw.frfs.H(k, 0) / exact(k, 0)).real();
  EXPECT_NEAR(mean / static_cast<double>(exact.rows() - 100), 1, 0.03);
}

TEST(ImpactTest, TheForceWindowHoldsASecondContactThatIsNoDoubleHit) {
  const auto truth = testing::ten_mode_truth(2);
  const ImpactRecordOptions record{.noise = 0};
  auto hits = testing::hammer_hits(record);
  for (std::size_t i = 0; i < 5; ++i) {
    hits.push_back({hits[i].time_s + 0.03, 0.02 * hits[i].peak, hits[i].duration_s});
  }
  const ImpactTest test =
      analyse(testing::impact_recording(truth, hits, record), 2, {.exponential_decay_rate_1_s = 2});
  EXPECT_EQ(test.frfs.averages, 5);
  EXPECT_GT(test.force_window_s, 0.03);
  EXPECT_LT(error_of(test.frfs, truth.accelerance(lines_below(test.frfs, 1300), 2)), 1e-3);
}

}  // namespace rigfit::signal::impact_test_test
