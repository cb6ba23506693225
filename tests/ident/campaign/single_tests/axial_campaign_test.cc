#include "ident/campaign/single_tests/axial_campaign.h"

#include "ident/campaign/modal/modal_model.h"
#include "model/linear/modal_analysis.h"
#include "tests/reference/axial_rig.h"
#include "tests/test.h"

namespace rigfit::ident::axial_campaign_test {

AxialInputs inputs_of(reference::AxialRig rig, std::vector<double> lengths, unsigned seed) {
  AxialInputs inputs{.setup = {.mass_kg = {rig.mass_kg, 0.001}}};
  inputs.setup.mass_per_length_kg_m = {rig.mass_per_length_kg_m, 0.001};
  inputs.setup.length_std_m = 0.0005;
  auto random = random_stream(seed, 1);
  for (const double length : lengths) {
    rig.length_m = length;
    for (int tap = 0; tap < 2; ++tap) {
      inputs.recordings.push_back({"tap", reference::axial_rig_record(rig, random), length});
    }
  }
  return inputs;
}

TEST(AxialCampaign, ACompliantRigIsToldFromItsLengths) {
  reference::AxialRig rig{.frame_N_m = 5e6};
  const auto result = axial_campaign(inputs_of(rig, {0.7, 1.0, 1.3}, 3));
  ASSERT_TRUE(result.test);
  const auto& r = *result.test;
  EXPECT_LT(r.EA_N.low, rig.EA_N);
  EXPECT_GT(r.EA_N.high, rig.EA_N);
  for (const auto& one : r.lengths) EXPECT_LT(one.EA_N.value, 0.98 * rig.EA_N);
  EXPECT_NEAR(r.series_compliance_m_N.value, 1 / 5e6, 4 * r.series_compliance_m_N.std);
  EXPECT_TRUE(says(result.findings, "series_compliance"));
  EXPECT_FALSE(r.conditional);
}

TEST(AxialCampaign, HumWithoutATapIsLeftOut) {
  auto inputs = inputs_of({}, {0.7, 1.0, 1.3}, 5);
  auto random = random_stream(5, 2);
  const reference::AxialRig still{.length_m = 1.3, .hum_N = 20, .tap_N_s = 0};
  inputs.recordings.push_back({"hum", reference::axial_rig_record(still, random), 1.3});
  const auto result = axial_campaign(inputs);
  ASSERT_TRUE(result.test);
  EXPECT_LT(result.test->EA_N.low, still.EA_N);
  EXPECT_GT(result.test->EA_N.high, still.EA_N);
}

TEST(AxialCampaign, OneLengthIsMarked) {
  reference::AxialRig rig;
  auto inputs = inputs_of(rig, {1.0}, 4);
  const auto result = axial_campaign(inputs);
  ASSERT_TRUE(result.test);
  EXPECT_TRUE(result.test->conditional);
  EXPECT_TRUE(says(result.findings, "one_length"));
  // What is known of the rig takes the mark away, and widens the interval by what it says.
  inputs.setup.series_compliance_std_m_N = 1e-7;
  const auto stated = axial_campaign(inputs);
  ASSERT_TRUE(stated.test);
  EXPECT_FALSE(stated.test->conditional);
  EXPECT_NEAR(stated.test->EA_N.std / stated.test->EA_N.value,
              std::hypot(1e-7 * rig.EA_N, result.test->EA_if_rigid_N.std / rig.EA_N), 0.002);
}

TEST(AxialCampaign, ARoundedRateIsInEAOfAllLengthsAlike) {
  const reference::AxialRig rig;
  auto inputs = inputs_of(rig, {0.7, 1.0, 1.3}, 6);
  inputs.setup.series_compliance_std_m_N = 0;  // one explanation: no mixture to move
  const auto exact = axial_campaign(inputs);
  constexpr double kRate = 5e-3;
  for (auto& one : inputs.recordings) one.recording.sample_rate_relative_std = kRate;
  const auto rounded = axial_campaign(inputs);
  ASSERT_TRUE(exact.test && rounded.test);
  const auto &a = *exact.test, &b = *rounded.test;
  // EA goes with the square of the rate; three lengths do not average that away. To first order:
  // the interval's shape moves by the square of 1 %.
  const double expected = std::hypot(a.EA_N.std / a.EA_N.value, 2 * kRate);
  EXPECT_NEAR(b.EA_N.std / b.EA_N.value, expected, 0.03 * expected);
  EXPECT_EQ(b.damping_ratio.std, a.damping_ratio.std);
  const auto row = [](const AxialTestResult& r, const std::string& source) {
    for (const auto& one : r.budget) {
      if (one.source == source) return one;
    }
    return BudgetRow{};
  };
  EXPECT_NEAR(row(b, "sample rate").contribution_N, 2 * kRate * b.EA_N.value,
              0.03 * 2 * kRate * b.EA_N.value);
  EXPECT_EQ(row(b, "hung mass").std, inputs.setup.mass_kg.std);
  double shares = 0;
  for (const auto& one : b.budget) shares += one.share;
  EXPECT_NEAR(shares, 1, 1e-9);
  EXPECT_TRUE(says(rounded.findings, "rate_uncertainty"));
  EXPECT_FALSE(says(exact.findings, "rate_uncertainty"));
}

TEST(AxialCampaign, APendulumIsNotTheAxialMode) {
  reference::AxialRig rig;
  // Twice the ripple: weight (1 + 3/4 a^2) swings by some 30 N, the tap by 70.
  rig.pendulum_rad = 1, rig.tap_N_s = 0.2, rig.after_s = 4;
  const auto result = axial_campaign(inputs_of(rig, {0.7, 1.3}, 5));
  ASSERT_TRUE(result.test);
  EXPECT_LT(result.test->EA_N.low, rig.EA_N);
  EXPECT_GT(result.test->EA_N.high, rig.EA_N);
}

TEST(AxialCampaign, IntervalsHoldOverRigs) {
  // 30 rigs a case: 95 % of 30 is 28.5 +- 1.2; three standard deviations less.
  reference::AxialStudy study{.lengths_m = {0.7, 1.0, 1.3}};
  study.rig.frame_N_m = 5e6, study.rig.hum_N = 3, study.rig.pendulum_rad = 0.1;
  study.rig.after_s = 1;
  const auto compliant = reference::axial_coverage(study, 30, 21);
  EXPECT_GE(compliant.covered, 25);
  EXPECT_EQ(compliant.silently_wrong, 0);
  study.rig.frame_N_m = 0, study.rig.hum_N = 0, study.rig.pendulum_rad = 0;
  const auto rigid = reference::axial_coverage(study, 30, 22);
  EXPECT_GE(rigid.covered, 25);
  EXPECT_LE(rigid.warned, 5);
}

TEST(AxialCampaign, RecordsOfTwoLengthsGivenAsOneAreRefused) {
  reference::AxialRig rig;
  auto inputs = inputs_of(rig, {1.0, 1.5}, 8);
  for (auto& one : inputs.recordings) one.length_m = 1.0;
  const auto mixed = axial_campaign(inputs);
  EXPECT_FALSE(mixed.test);
  ASSERT_TRUE(says(mixed.findings, "lengths_mixed"));
  EXPECT_THAT(mixed.findings.back().message, HasSubstr("--length"));
  for (auto& one : inputs.recordings) one.length_m = &one - inputs.recordings.data() < 2 ? 1 : 1.5;
  EXPECT_TRUE(axial_campaign(inputs).test);
}

TEST(AxialCampaign, UnitsThatContradictTheRecordsAreRefused) {
  reference::AxialRig rig;
  const auto inputs = inputs_of(rig, {0.8}, 9);
  ASSERT_TRUE(axial_campaign(inputs).test);
  auto millimetres = inputs;
  for (auto& one : millimetres.recordings) one.length_m = 800;
  const auto long_cable = axial_campaign(millimetres);
  EXPECT_FALSE(long_cable.test);
  EXPECT_TRUE(says(long_cable.findings, "length_suspected"));
  // The cell's mean is the weight: a mass in grams, or volts taken as millivolts, is off by 1000.
  auto grams = inputs;
  grams.setup.mass_kg = {1000 * rig.mass_kg, 1};
  EXPECT_FALSE(axial_campaign(grams).test);
  EXPECT_TRUE(says(axial_campaign(grams).findings, "force_mismatch"));
  for (const double factor : {1e-3, 1e3, 1 / 9.80665}) {
    auto scaled = inputs;
    for (auto& one : scaled.recordings) one.recording.channels[0].samples *= factor;
    EXPECT_TRUE(says(axial_campaign(scaled).findings, "force_mismatch")) << factor;
  }
  auto light = inputs;
  light.setup.mass_kg = {0.87 * rig.mass_kg, 0.01};
  EXPECT_TRUE(axial_campaign(light).test);
  EXPECT_TRUE(says(axial_campaign(light).findings, "force_mismatch"));
  // A cell set to zero under the mass says nothing of it.
  auto tared = inputs;
  for (auto& one : tared.recordings) {
    auto& samples = one.recording.channels[0].samples;
    samples.array() -= samples.mean() + 0.3;
  }
  EXPECT_TRUE(axial_campaign(tared).test);
}

TEST(AxialCampaign, RefusesWithReasons) {
  reference::AxialRig rig;
  auto inputs = inputs_of(rig, {1.0}, 6);
  inputs.channel = "load";
  const auto result = axial_campaign(inputs);
  EXPECT_FALSE(result.test);
  EXPECT_TRUE(says(result.findings, "channel"));
  EXPECT_TRUE(says(result.findings, "no_decay"));
}

TEST(AxialCampaign, GoesIntoScenesWithItsUncertainty) {
  SceneUse use;
  use.scene.nodes.resize(2), use.scene.members.resize(1);
  auto& cable = use.scene.members[0];
  cable.name = "cable", cable.EA = 1, cable.damping_ratio = 0.1, cable.tension = 100;
  use.EA_of = {"cable.EA"}, use.damping_of = {"cable.damping_ratio"};
  const KnownValues known{{}, {2e5, 500}, {0.017, 0.001}};
  const auto scene = scene_at(use, known, {});
  EXPECT_EQ(scene.members[0].EA, 2e5);
  EXPECT_EQ(*scene.members[0].damping_ratio, 0.017);
  const auto inputs = known_inputs(known, {{}, {}, {use, {}}});
  ASSERT_EQ(inputs.size(), 2u);
  ASSERT_EQ(inputs[0].effects.size(), 1u);
  EXPECT_EQ(inputs[0].effects[0].state, 2);
  EXPECT_EQ(inputs[0].effects[0].target, "cable.EA");
  EXPECT_EQ(inputs[0].effects[0].change, 500);
  ASSERT_EQ(inputs[1].effects.size(), 1u);
  EXPECT_EQ(inputs[1].effects[0].change, 0.001);
}

}  // namespace rigfit::ident::axial_campaign_test
