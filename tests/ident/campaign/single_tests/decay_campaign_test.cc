#include "ident/campaign/single_tests/decay_campaign.h"

#include "tests/test.h"

namespace rigfit::ident::decay_test_test {

/// Taps of an oscillator of 7 Hz, damping 0.01, at 200 Hz; the record starts at 100 s.
signal::Recording taps(const std::vector<std::pair<double, double>>& hits, double seconds,
                       double noise, unsigned seed, double frequency_scatter = 0) {
  Normal normal(seed);
  signal::Recording recording{.sample_rate_hz = 200, .start_time_s = 100};
  signal::Channel channel{.name = "acceleration"};
  channel.samples.setZero(static_cast<Index>(seconds * 200));
  for (const auto& [at, amplitude] : hits) {
    const double w = 2 * kPi * (7 + frequency_scatter * normal());
    for (Index j = static_cast<Index>(std::ceil(at * 200)); j < channel.samples.size(); ++j) {
      const double t = static_cast<double>(j) / 200 - at;
      channel.samples(j) += amplitude * std::exp(-0.01 * w * t) * std::sin(w * t);
    }
  }
  for (double& value : channel.samples) value += noise * normal();
  recording.channels.push_back(channel);
  return recording;
}

TEST(DecayTest, ListsEveryDecayAndFitsTheStrongest) {
  // Down to a tenth of the first.
  const auto recording = taps({{3, 1}, {15, 0.5}, {27, 0.1}}, 40, 0.002, 1);
  const auto test = run_decay_test({.recording = recording}, {});
  ASSERT_EQ(test.channels.size(), 1u);
  const auto& found = test.channels[0];
  ASSERT_EQ(found.decays.size(), 3u);
  const double hits[] = {103, 115, 127};
  for (std::size_t k = 0; k < 3; ++k) {
    // Half a cycle (0.07 s) is left to the impact; two cycles end before the next.
    EXPECT_NEAR(found.decays[k].start_s, hits[k] + 0.07, 0.07) << k;
    EXPECT_EQ(found.decays[k].fitted, k == 0) << k;
    if (k > 0) {
      EXPECT_LT(found.decays[k - 1].end_s, hits[k]) << k;
    }
  }
  EXPECT_DOUBLE_EQ(found.start_s, found.decays[0].start_s);
  const auto& zeta = found.result.modes.at(0).damping_ratio;
  EXPECT_NEAR(zeta.value, 0.01, 5 * zeta.std);
  EXPECT_LT(zeta.std, 1e-4);
}

TEST(DecayTest, EachIsFittedAndTheirScatterIsToldFromTheUncertaintyOfTheMean) {
  const auto recording =
      taps({{1, 1}, {13, 0.6}, {25, 0.8}, {37, 0.4}, {49, 1}, {61, 0.7}}, 73, 0.003, 2, 0.005);
  const auto test = run_decay_test({.recording = recording}, {.each = true});
  const auto& found = test.channels.at(0);
  ASSERT_EQ(found.decays.size(), 6u);
  for (const auto& decay : found.decays) EXPECT_TRUE(decay.fitted);
  ASSERT_EQ(found.pooled.size(), 1u);
  const auto& mode = found.pooled[0];
  EXPECT_EQ(mode.decays, 6u);
  // tau = 0.005 Hz from six decays: its estimate is within a factor of 3 (chi-squared with five
  // degrees, 1e-3 on either side: 0.20 to 2.0), the mean's uncertainty tau / sqrt(6).
  EXPECT_GT(mode.frequency_scatter_hz, 0.001);
  EXPECT_LT(mode.frequency_scatter_hz, 0.0103);
  EXPECT_NEAR(mode.frequency_hz.std, mode.frequency_scatter_hz / std::sqrt(6), 1e-4);
  EXPECT_NEAR(mode.frequency_hz.value, 7, 5 * 0.005 / std::sqrt(6));
  EXPECT_NEAR(mode.damping_ratio.value, 0.01, 5 * mode.damping_ratio.std);
}

TEST(DecayTest, ARoundedRateIsInTheUncertaintyOfFrequenciesAndNotOfDamping) {
  auto recording = taps({{1, 1}, {13, 0.6}, {25, 0.8}}, 37, 0.003, 4);
  DecayTestOptions options{.each = true};
  const auto exact = run_decay_test({.recording = recording}, options);
  recording.sample_rate_relative_std = 3e-4;
  const auto rounded = run_decay_test({.recording = recording}, options);
  const auto &before = exact.channels.at(0), &after = rounded.channels.at(0);
  const auto &a = before.result.modes.at(0), &b = after.result.modes.at(0);
  const double common = 3e-4 * a.frequency_hz.value;
  EXPECT_EQ(b.frequency_hz.value, a.frequency_hz.value);
  EXPECT_DOUBLE_EQ(b.frequency_hz.std, std::hypot(a.frequency_hz.std, common));
  EXPECT_EQ(b.damping_ratio.std, a.damping_ratio.std);
  EXPECT_LT(b.frequency_interval_95_hz.low, b.frequency_hz.value - 1.95 * common);
  // Three decays do not average it away.
  EXPECT_GT(after.pooled.at(0).frequency_hz.std, common);
  EXPECT_LT(before.pooled.at(0).frequency_hz.std, 0.5 * common);
  ASSERT_EQ(rounded.findings.size(), exact.findings.size() + 1);
  EXPECT_EQ(rounded.findings.back().code, "rate_uncertainty");
}

TEST(DecayTest, RefusesARecordingWithoutAnEvenRate) {
  auto recording = taps({{0, 1}}, 1, 0.002, 4);
  recording.sample_rate_hz = 0;
  const auto test = run_decay_test({.recording = recording}, {});
  EXPECT_TRUE(test.channels.empty());
  ASSERT_EQ(test.findings.size(), 1u);
  EXPECT_TRUE(test.findings[0].refused);
}

}  // namespace rigfit::ident::decay_test_test
