// Hits of the virtual laboratory's beam (testdata/virtual_laboratory), some of them made unfit.
#include "ident/campaign/modal/modal_campaign.h"

#include "signal/readers/read_recording.h"
#include "tests/reference/ambient_motion.h"
#include "tests/test.h"

namespace rigfit::ident {
namespace {

signal::Recording hit(int number) {
  return signal::read_recording(std::string(RIGFIT_TESTDATA) +
                                "/virtual_laboratory/beam/rig/hammer-hit" + std::to_string(number) +
                                ".uff");
}

ModalTestOptions options() {
  ModalTestOptions options{.hammer = {.force = "force"}};
  options.hammer.impact.hits.band_hz = {1.0, 160.0};
  options.hammer.impact.exponential_end_level = 0.05;
  return options;
}

std::vector<TestRecording> hits(const std::string& place, std::optional<double> tension_N) {
  std::vector<TestRecording> list;
  for (int k = 1; k <= 4; ++k) {
    list.push_back({.recording = hit(k), .tension_N = tension_N, .place = place});
  };
  return list;
}

TEST(ModalTest, StatesByTensionAndTheSameNumbersWhateverTheyAreBeside) {
  auto recordings = hits("", 300.0);
  for (auto& one : hits("", 200.0)) recordings.push_back(std::move(one));
  const auto test = run_modal_test(std::move(recordings), options());
  ASSERT_EQ(test.states.size(), 2u);
  EXPECT_EQ(test.states[0].tension_N, 200.0);
  EXPECT_TRUE(test.findings.empty());
  const auto& state = test.states[1];
  ASSERT_TRUE(state.has_modes());
  EXPECT_EQ(state.hammer.frfs.inputs[0].name, "hammer");
  EXPECT_EQ(state.channels.size(), state.directions.size());
  // The hammer test by itself, and its modes: nothing is added on the way.
  const auto alone = run_modal_test(hits("", {}), options());
  const auto& modes = alone.states.at(0).modal->model.modes;
  ASSERT_EQ(modes.size(), state.modal->model.modes.size());
  for (std::size_t k = 0; k < modes.size(); ++k) {
    EXPECT_EQ(modes[k].pole_rad_s, state.modal->model.modes[k].pole_rad_s);
  }
}

TEST(ModalTest, ARoundedRateIsInTheFrequenciesAndNotInTheDamping) {
  const auto exact = run_modal_test(hits("", {}), options());
  auto recordings = hits("", {});
  constexpr double kRate = 3e-4;
  for (auto& one : recordings) one.recording.sample_rate_relative_std = kRate;
  const auto rounded = run_modal_test(std::move(recordings), options());
  const auto &a = exact.states.at(0).modal->model, &b = rounded.states.at(0).modal->model;
  ASSERT_EQ(a.modes.size(), b.modes.size());
  ASSERT_GT(a.modes.size(), 1u);
  for (std::size_t k = 0; k < a.modes.size(); ++k) {
    const double f = a.modes[k].frequency_hz.value;
    EXPECT_EQ(b.modes[k].frequency_hz.value, f);
    EXPECT_DOUBLE_EQ(b.modes[k].frequency_hz.std,
                     std::hypot(a.modes[k].frequency_hz.std, kRate * f));
    EXPECT_EQ(b.modes[k].damping_ratio.std, a.modes[k].damping_ratio.std);
  }
  // Common to all: the covariance of two frequencies gets the product of their parts.
  const double together =
      kRate * kRate * a.modes[0].frequency_hz.value * a.modes[1].frequency_hz.value;
  EXPECT_NEAR(b.pole_covariance(0, 2) - a.pole_covariance(0, 2), together, 1e-9 * together);
  EXPECT_TRUE(says(rounded.states[0].findings, "rate_uncertainty"));
}

TEST(ModalTest, WhatCannotTakePartIsRefusedWithItsReason) {
  auto recordings = hits("", {});
  const auto spoilt = [&](const char* path, auto change) {
    TestRecording one{.recording = hit(5)};
    one.recording.path = path;
    change(one.recording);
    recordings.push_back(std::move(one));
  };
  spoilt("slow", [](signal::Recording& r) { r.sample_rate_hz /= 2; });
  spoilt("renamed", [](signal::Recording& r) { r.channels[0].name = "trigger"; });
  spoilt("volts", [](signal::Recording& r) { r.channels[0].unit = "V"; });
  const auto test = run_modal_test(std::move(recordings), options());
  ASSERT_EQ(test.findings.size(), 3u);
  const char* reasons[] = {"is sampled at", "has no channel \"force\"", "is in V, not in N"};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_TRUE(test.findings[k].refused);
    EXPECT_THAT(test.findings[k].message, HasSubstr(reasons[k]));
  }
  EXPECT_TRUE(test.states.at(0).has_modes());
}

TEST(ModalTest, APlaceWithoutAUsableHitIsLeftOutAndDoesNotShortenTheOthers) {
  auto recordings = hits("tip", {});
  TestRecording gaps{.recording = hit(5), .place = "foot"};
  gaps.recording.channels[1].samples.segment(200, 40).setConstant(kNaN);
  recordings.push_back(std::move(gaps));
  const auto test = run_modal_test(std::move(recordings), options());
  const auto& state = test.states.at(0);
  ASSERT_EQ(state.hammer.frfs.inputs.size(), 1u);
  const auto alone = run_modal_test(hits("tip", {}), options());
  EXPECT_EQ(state.hammer.frfs.H, alone.states[0].hammer.frfs.H);
  ASSERT_FALSE(state.findings.empty());
  bool said = false;
  for (const auto& finding : state.findings) {
    said = said || (finding.code == "point_left_out" && finding.where == "foot");
  }
  EXPECT_TRUE(said);
}

// Two set-ups of sensors that share two: frequencies of five storeys within three standard
// uncertainties, shapes at all sensors.
TEST(ModalTest, AmbientMotionIsJoinedOverItsSetUps) {
  const auto structure = reference::five_storeys();
  ModalTestOptions options{.ambient = true, .references = {"c1", "c5"}};
  std::vector<TestRecording> recordings;
  for (const int without : {1, 2}) {
    TestRecording one;
    one.recording = reference::recorded(
        structure, {.seed = static_cast<std::uint64_t>(without), .amplitude = {}});
    one.recording.channels.erase(one.recording.channels.begin() + without);
    one.recording.path = "set-up " + std::to_string(without);
    recordings.push_back(std::move(one));
  }
  const auto test = run_modal_test(recordings, options);
  ASSERT_EQ(test.states.size(), 1u);
  const auto& state = test.states[0];
  ASSERT_TRUE(state.has_modes());
  EXPECT_EQ(state.channels.size(), 5u);
  const auto& modes = state.modal->model.modes;
  for (const double truth : structure.frequency_hz) {
    EXPECT_TRUE(std::any_of(modes.begin(), modes.end(), [&](const auto& mode) {
      const auto& f = mode.frequency_hz;
      return !mode.doubtful && std::abs(f.value - truth) < 3 * f.std && mode.shape.size() == 5;
    })) << truth;
  }
  options.references = {"nowhere"};
  const auto refused = run_modal_test(recordings, options);
  EXPECT_FALSE(refused.states[0].has_modes());
  EXPECT_TRUE(refused.states[0].findings.at(0).refused);
}

TEST(HammerTest, ContradictingOptionsAreRefused) {
  std::vector<signal::StruckPoint> places{{"", {hit(1)}}};
  HammerTestOptions wrong{.force = "force", .responses = {"force"}};
  EXPECT_THROW((void)analyse_hammer_test(places, wrong), std::invalid_argument);
  wrong.responses = {"beam 0.65 m"};
  wrong.driving_point = "force";
  EXPECT_THROW((void)analyse_hammer_test(places, wrong), std::invalid_argument);
}

}  // namespace
}  // namespace rigfit::ident
