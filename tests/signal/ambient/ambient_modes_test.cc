#include "signal/ambient/ambient_modes.h"

#include <cstdint>

#include "signal/numerics/numbers.h"
#include "tests/reference/ambient_motion.h"
#include "tests/signal/readers/reading.h"
#include "tests/test.h"

namespace rigfit::signal::ambient_modes_test {

AmbientOptions band(double low, double high) {
  AmbientOptions options;
  options.low_hz = low, options.high_hz = high;
  return options;
}

Recording chain(std::uint64_t seed, double duration_s = 1200, double damping = 0.02) {
  reference::AmbientMotion motion;
  motion.seed = seed, motion.duration_s = duration_s;
  return reference::recorded(reference::five_storeys(damping), motion);
}

std::vector<AmbientMode> sure(const AmbientResult& result) {
  std::vector<AmbientMode> modes;
  for (const auto& one : result.modes)
    if (!one.mode.doubtful) modes.push_back(one);
  return modes;
}

long noted(const AmbientResult& result, const std::string& code) {
  return std::count_if(result.notes.begin(), result.notes.end(),
                       [&](const Note& note) { return note.code == code; });
}

/// Of 95 % intervals, at least 82 % of 40 to 50 hold with a chance of 99.9 % (binomial).
void expect_chain(const std::vector<AmbientMode>& modes, int& held_f, int& held_zeta,
                  double damping = 0.02) {
  const auto truth = reference::five_storeys(damping);
  ASSERT_EQ(modes.size(), 5);
  for (Index r = 0; r < 5; ++r) {
    const auto& one = modes[r];
    const double f = truth.frequency_hz[r];
    // Four standard deviations at twice the bound of the shortest record, T / tau = 134.
    EXPECT_NEAR(one.mode.frequency_hz.value, f, 4 * 2 * damping * f / std::sqrt(134.0));
    EXPECT_NEAR(one.mode.damping_ratio.value, damping, 4 * 2 * damping / std::sqrt(134.0));
    held_f += one.frequency_95.low < f && f < one.frequency_95.high;
    held_zeta += one.damping_95.low < damping && damping < one.damping_95.high;
  }
}

TEST(AmbientModes, ChainOfFiveStoreysUnderForcesThatCorrelateOrNot) {
  auto truth = reference::five_storeys();
  for (const double correlation : {0.0, 0.7}) {
    truth.forces.setConstant(correlation), truth.forces.diagonal().setOnes();
    int held_f = 0, held_zeta = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      reference::AmbientMotion motion;
      motion.seed = seed;
      const auto result = ambient_modes(reference::recorded(truth, motion), band(0.3, 8));
      EXPECT_TRUE(result.tones.empty());
      const auto modes = sure(result);
      ASSERT_NO_FATAL_FAILURE(expect_chain(modes, held_f, held_zeta));
      for (Index r = 0; r < 5; ++r) {
        const auto& shape = modes[r].mode.shape;
        EXPECT_GT(mac(shape, VectorXcd(truth.shapes.col(r))), 0.98);
        EXPECT_GT(modes[r].mode.modal_phase_collinearity, 0.95);
      }
    }
    EXPECT_GE(held_f, 41) << correlation;
    EXPECT_GE(held_zeta, 41) << correlation;
  }
}

// No band is asked for: nine tenths of the lines hold noise. Half the order finds five modes.
TEST(AmbientModes, TenModesInAFifthOfTheBand) {
  const auto truth = reference::storeys(10, 0.419, 0.01);
  reference::AmbientMotion motion;
  motion.rate_hz = 50;
  const auto modes = sure(ambient_modes(reference::recorded(truth, motion), {}));
  EXPECT_GE(modes.size(), 9);
  for (const auto& one : modes) {
    const double f = one.mode.frequency_hz.value;
    // A quarter of the half bandwidth.
    EXPECT_LT((truth.frequency_hz.array() / f - 1).abs().minCoeff(), 0.25 * 0.01) << f;
  }
}

TEST(AmbientModes, SameNumbersFromSeveralThreads) {
  auto options = band(0.3, 8);
  const auto one = ambient_modes(chain(3), options);
  options.threads = 3;
  const auto three = ambient_modes(chain(3), options);
  ASSERT_EQ(one.modes.size(), three.modes.size());
  for (std::size_t i = 0; i < one.modes.size(); ++i) {
    EXPECT_EQ(one.modes[i].mode.frequency_hz.value, three.modes[i].mode.frequency_hz.value);
    EXPECT_EQ(one.modes[i].mode.frequency_hz.std, three.modes[i].mode.frequency_hz.std);
  }
}

TEST(AmbientModes, ToneWithinAModesBandwidth) {
  Recording recording = chain(4);
  for (auto& channel : recording.channels) {
    const double size = 0.3 * channel.samples.norm() / std::sqrt(double(channel.samples.size()));
    for (Index k = 0; k < channel.samples.size(); ++k)
      channel.samples[k] += std::sqrt(2.0) * size * std::cos(kTwoPi * 2.61 * double(k) / 20 + 0.7);
  }
  const AmbientResult result = ambient_modes(recording, band(0.3, 8));
  ASSERT_EQ(result.tones.size(), 1);
  EXPECT_NEAR(result.tones[0].frequency_hz, 2.61, 0.1 / 1200);  // a tenth of a line
  int held_f = 0, held_zeta = 0;
  expect_chain(sure(result), held_f, held_zeta);
}

TEST(AmbientModes, DriftBelowTheBandIsTakenOut) {
  Recording recording = chain(6);
  for (Index c = 0; c < 5; ++c) {
    auto& x = recording.channels[c].samples;
    const double size = 20 * x.norm() / std::sqrt(double(x.size()));
    for (Index k = 0; k < x.size(); ++k)
      x[k] += size * std::sin(kTwoPi * 3 * double(k) / double(x.size()) + double(c));
  }
  int held_f = 0, held_zeta = 0;
  expect_chain(sure(ambient_modes(recording, band(0.3, 8))), held_f, held_zeta);
}

TEST(AmbientModes, MissingSamplesAreMissingProducts) {
  Recording recording = chain(5);
  for (Index k = 0; k < recording.samples(); ++k)
    if (k % 2000 < 100) recording.channels[k / 2000 % 5].samples[k] = kNaN;
  int held_f = 0, held_zeta = 0;
  expect_chain(sure(ambient_modes(recording, band(0.3, 8))), held_f, held_zeta);
}

TEST(AmbientModes, PairWithinItsBandwidth) {
  const auto truth = reference::close_pair(0.005, 6);
  int held = 0;
  double mean_mac = 0;
  for (std::uint64_t seed = 2; seed <= 6; ++seed) {
    reference::AmbientMotion motion;
    motion.seed = seed, motion.rate_hz = 10, motion.duration_s = 3600;
    const auto result = ambient_modes(reference::recorded(truth, motion), band(1, 3));
    const auto modes = sure(result);
    ASSERT_EQ(modes.size(), 2);
    EXPECT_EQ(noted(result, "close_modes"), 1);
    for (Index r = 0; r < 2; ++r) {
      const auto& one = modes[r];
      // Shapes mix within the bandwidths, which the note says.
      const double alike = mac(one.mode.shape, VectorXcd(truth.shapes.col(r)));
      EXPECT_GT(alike, 0.5);
      mean_mac += alike / 10;
      held += one.frequency_95.low < truth.frequency_hz[r] &&
              truth.frequency_hz[r] < one.frequency_95.high;
    }
  }
  EXPECT_GE(held, 7);  // of 10
  EXPECT_GT(mean_mac, 0.7);
}

TEST(AmbientModes, RecordingTooShortSaysTheLengthThatServes) {
  // 40 decay times of 0.2 % at 0.89 Hz are 40 / (0.002 2 pi 0.89) = 3577 s.
  const AmbientResult result = ambient_modes(chain(6, 600, 0.002), band(0.3, 2));
  ASSERT_FALSE(result.modes.empty());
  EXPECT_TRUE(sure(result).empty());
  ASSERT_GE(noted(result, "too_short"), 1);
  EXPECT_EQ(result.modes[0].code, "too_short");
  EXPECT_LT(result.modes[0].decay_times, 40);
}

TEST(AmbientModes, NoModesInNoise) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    Recording recording;
    recording.sample_rate_hz = 20;
    for (const char* name : {"a", "b", "c", "d", "e"}) {
      Channel channel;
      channel.name = name;
      channel.samples = VectorXd::NullaryExpr(24000, [&] { return normal(random); });
      recording.channels.push_back(std::move(channel));
    }
    const AmbientResult result = ambient_modes(recording, band(0.3, 8));
    EXPECT_TRUE(sure(result).empty());
    EXPECT_TRUE(result.tones.empty());
  }
}

// Fewer channels than modes: no filter silences all neighbours of a mode.
TEST(AmbientModes, ShapesOfThreeChannels) {
  auto options = band(0.3, 8);
  options.channels = {"c1", "c3", "c5"};
  const auto truth = reference::five_storeys().shapes;
  double squares = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    for (Index r = 0; const auto& one : sure(ambient_modes(chain(seed, 3600, 0.01), options))) {
      const auto& std = one.mode.shape_std;
      VectorXd error = truth({0, 2, 4}, r++);
      error = one.mode.shape.real() -
              error / one.mode.shape.real().dot(error) * one.mode.shape.real().squaredNorm();
      squares += error.cwiseQuotient(std.col(0).cwiseMax(std.col(0).mean())).squaredNorm() / 60;
    }
  }
  EXPECT_LT(squares, 1.5);
}

TEST(AmbientModes, OneChannelGivesPolesToo) {
  auto options = band(0.3, 8);
  options.channels = {"c5"};
  const auto modes = sure(ambient_modes(chain(7), options));
  EXPECT_GE(modes.size(), 3);
}

TEST(AmbientModes, ConstantChannelIsRefusedByName) {
  Recording recording = chain(1, 300);
  recording.channels[2].samples.setConstant(3);
  const RecordingError error = error_of([&] { (void)ambient_modes(recording, band(0.3, 8)); });
  EXPECT_EQ(error.where().channel, "c3");
}

/// Two set-ups with references c1 and c5; c5's sensitivity is 1.3 times as high in the second, and
/// the wind 1.6 times as strong.
std::vector<AmbientResult> two_setups(std::uint64_t seed) {
  auto options = band(0.3, 8);
  options.channels = {"c1", "c5", "c2"};
  std::vector<AmbientResult> setups{ambient_modes(chain(seed), options)};
  Recording second = chain(seed + 100);
  for (auto& channel : second.channels) channel.samples *= 1.6;
  second.channels[4].samples *= 1.3;
  options.channels = {"c1", "c5", "c3", "c4"};
  setups.push_back(ambient_modes(second, options));
  return setups;
}

TEST(MergedSetups, ShapesByReferencesAndAChangedGain) {
  const auto truth = reference::five_storeys();
  int held_f = 0, held_zeta = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const AmbientResult merged = merge_setups(two_setups(seed));
    ASSERT_EQ(merged.channels, (std::vector<std::string>{"c1", "c5", "c2", "c3", "c4"}));
    const auto modes = sure(merged);
    ASSERT_NO_FATAL_FAILURE(expect_chain(modes, held_f, held_zeta));
    for (Index r = 0; r < 5; ++r) {
      const VectorXcd shape = truth.shapes(std::vector<Index>{0, 4, 1, 2, 3}, r);
      EXPECT_GT(mac(modes[r].mode.shape, shape), 0.95);
    }
    EXPECT_EQ(noted(merged, "setup_lacks_mode"), 0);
    ASSERT_EQ(noted(merged, "gain_changed"), 1);
    const auto gain = std::ranges::find(merged.notes, "gain_changed", &Note::code);
    EXPECT_THAT(gain->message, HasSubstr("c5"));
  }
  EXPECT_GE(held_f, 33);  // of 40
  EXPECT_GE(held_zeta, 33);
}

TEST(MergedSetups, MissingReferenceNamesThoseThatServe) {
  auto setups = two_setups(1);
  const RecordingError error = error_of([&] { (void)merge_setups(setups, {"c2"}); });
  EXPECT_THAT(error.what(), HasSubstr("set-up 2: channel \"c2\": the reference is missing"));
  EXPECT_THAT(error.remedy(), HasSubstr("\"c1\", \"c5\""));
  for (auto& one : setups[1].modes) one.mode.shape[1] *= -1;  // c5 turned round
  const AmbientResult apart = merge_setups(setups);
  const auto shapeless = [](const AmbientMode& one) { return one.mode.shape.size() == 0; };
  EXPECT_GE(noted(apart, "setup_lacks_mode"), 5);
  EXPECT_EQ(std::ranges::count_if(apart.modes, shapeless), noted(apart, "setup_lacks_mode"));
}

// A structure that warms up by one bandwidth, and a mode that neither set-up is sure of.
TEST(MergedSetups, ModesThatShiftAndDoubtfulOnesAreListedOnce) {
  auto setups = two_setups(1);
  for (auto& one : setups[1].modes) {
    one.mode.frequency_hz.value *= 1 + 2 * one.mode.damping_ratio.value;
  }
  for (auto& setup : setups) setup.modes.front().mode.doubtful = true;
  const AmbientResult merged = merge_setups(setups);
  EXPECT_EQ(sure(merged).size(), 4U);
  EXPECT_EQ(merged.modes.size(), 5U);
  EXPECT_EQ(noted(merged, "groups_differ"), 4);
}

}  // namespace rigfit::signal::ambient_modes_test
