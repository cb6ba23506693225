#include "ident/campaign/single_tests/tension_campaign.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>

namespace rigfit::ident::tension_campaign_test {
namespace {

constexpr double kTension = 1000, kLength = 10, kMass = 1;

/// A taut string of 1000 N, 10 m and 1 kg/m plucked: five modes for 60 s at 200 Hz.
TensionInputs plucked_string() {
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  TensionRecording one;
  one.name = "pluck";
  one.recording.sample_rate_hz = 200;
  signal::Channel channel;
  channel.name = "acceleration";
  channel.samples.resize(12000);
  for (Eigen::Index j = 0; j < channel.samples.size(); ++j) {
    const double t = static_cast<double>(j) / 200;
    double sum = 0.01 * normal(generator);
    for (int n = 1; n <= 5; ++n) {
      const double w = std::numbers::pi * n * std::sqrt(kTension / kMass) / kLength;
      sum += std::exp(-0.002 * w * t) * std::sin(w * t);
    }
    channel.samples[j] = sum;
  }
  one.recording.channels.push_back(std::move(channel));
  TensionInputs inputs;
  inputs.test.name = "cable";
  auto& cable = inputs.test.cable;
  cable.length_m = {kLength, 0.005};
  cable.mass_per_length = {kMass, 0.001};
  cable.EI_Nm2 = signal::Estimate{1, 0};
  cable.EA_N = signal::Estimate{1e6, 0};
  inputs.test.options.ends = {CableEnds::pinned};
  inputs.max_peaks = 5;
  inputs.recordings.push_back(std::move(one));
  return inputs;
}

double budget(const TensionResult& result, const std::string& source) {
  for (const auto& term : result.budget) {
    if (term.source == source) return term.std;
  }
  return 0;
}

// T goes with the square of the rate, whatever the number of modes. EI is 1 N m2: its part in the
// stiffness of the highest mode is (5 pi / L)^2 EI / T = 0.25 %, and so is what it adds to that 2.
TEST(TensionCampaign, ARoundedRateIsInTheTensionOfAllModesAlike) {
  auto inputs = plucked_string();
  const auto exact = tension_campaign(inputs);
  constexpr double kRate = 1e-3;
  inputs.recordings[0].recording.sample_rate_relative_std = kRate;
  const auto rounded = tension_campaign(inputs);
  const auto &a = exact.result.tension, &b = rounded.result.tension;
  ASSERT_TRUE(a.solved && b.solved);
  EXPECT_NEAR(b.tension_N.value, kTension, 4 * b.tension_N.std);
  const double expected = std::hypot(a.tension_N.std, 2 * kRate * kTension);
  EXPECT_NEAR(b.tension_N.std, expected, 0.01 * expected);
  EXPECT_GT(b.high - b.low, 1.05 * (a.high - a.low));
  EXPECT_NEAR(budget(b, "sample rate"), 2 * kRate * kTension, 0.01 * 2 * kRate * kTension);
  EXPECT_NEAR(budget(b, "mass per length"), budget(a, "mass per length"),
              1e-3 * budget(a, "mass per length"));
  double squares = 0;
  for (const auto& term : b.budget) squares += term.std * term.std;
  EXPECT_NEAR(std::sqrt(squares), b.tension_N.std, 1e-9 * b.tension_N.std);
  const auto says = [](const TensionCampaignResult& result) {
    const auto& all = result.result.findings;
    return std::any_of(all.begin(), all.end(),
                       [](const auto& one) { return one.code == "rate_uncertainty"; });
  };
  EXPECT_TRUE(says(rounded));
  EXPECT_FALSE(says(exact));
}

}  // namespace
}  // namespace rigfit::ident::tension_campaign_test
