#include "model/scene/actual_state.h"

#include "model/linear/modal_analysis.h"
#include "model/scene/parameters.h"
#include "model/scene/read_scene.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::actual_state_test {

std::vector<double> frequencies(const Scene& scene) {
  std::vector<double> found;
  for (const auto& mode : analyse_modes(scene, {.count = 6}).modes)
    found.push_back(mode.frequency_hz);
  return found;
}

TEST(ActualState, ACableIsAsTightAsItsLoadCellMeans) {
  Scene read = testing::paper_cable(100, 0.5);
  read.load_cell = {1.03, -2};
  EXPECT_EQ(frequencies(read), frequencies(testing::paper_cable(1.03 * 100 - 2, 0.5)));
}

// Between fixed ends T / EA - (w L / T)^2 / 24, what a cable is longer than its chord by elasticity
// less what it is longer by sag (a parabola), falls by alpha dT. Left out: 1/30^2 of the sag's part
// and the strain of 1e-3.
TEST(ActualState, AWarmCableIsSlack) {
  Scene cold = testing::paper_cable(200, 0.5);
  cold.members[0].tension.reset();
  cold.members[0].stretch = 2.4 * 200 / 221780.0;
  cold.members[0].thermal_expansion = 1.2e-5;
  Scene warm = cold;
  warm.temperature_change = 20;
  const auto tension = [&](const Scene& scene) {
    return analyse_modes(scene, {.count = 1}).equilibrium.members[0].tension_N;
  };
  const double weight = 0.16667 * kStandardGravity * 2.4;
  const auto excess = [&](double T) { return T / 221780 - weight * weight / (24 * T * T); };
  EXPECT_NEAR(excess(tension(cold)) - excess(tension(warm)), 1.2e-5 * 20, 2e-3 * 1.2e-5 * 20);
  // Given by its length instead, it is the same cable.
  Scene by_length = warm;
  by_length.members[0].unstretched_length = 2.4 - *cold.members[0].stretch;
  by_length.members[0].stretch.reset();
  EXPECT_NEAR(tension(by_length), tension(warm), 1e-9 * 221780);
}

void expect_refused(Scene scene, const std::string& reason) {
  EXPECT_THAT([&] { static_cast<void>(parse_scene(scene_text(scene), "bad.toml")); },
              ::testing::ThrowsMessage<SceneError>(HasSubstr(reason)));
}

TEST(ActualState, WhatChangesNothingOrLeavesNoTensionIsRefused) {
  Scene scene = testing::paper_cable(100, 0.5);
  scene.load_cell = {1, -100};
  expect_refused(scene, "must be positive");
  EXPECT_THROW(static_cast<void>(analyse_modes(scene)), SceneError);
  scene.load_cell = {};
  scene.temperature_change = 10;
  expect_refused(scene, "no cable has a thermal_expansion");
  scene.members[0].thermal_expansion = 1.2e-5;
  expect_refused(scene, "tension is given");
  scene.members[0].tension.reset();
  scene.members[0].stretch = 0.002;
  scene.load_cell = {1.01, 0};
  expect_refused(scene, "none is given by its tension");
}

// A string whose mass is that of its length as it hangs: f = sqrt(T / m) / (2 L) of that m, at a
// strain of 2 % where the unstretched length's would be 1 % off; the same by its stretch.
TEST(ActualState, MassOfTheInstalledLength) {
  Scene string = testing::paper_cable(2000, 0, 0);
  string.gravity.setZero();
  Member& cable = string.members[0];
  cable.EA = 1e5;
  EXPECT_NEAR(undecided_mass(string), 0.02, 1e-12);
  cable.mass_of = Member::MassOf::installed;
  EXPECT_EQ(undecided_mass(string), 0);
  string.accuracy = 1e-7;
  const double hz = std::sqrt(2000 / 0.16667) / (2 * 2.4);
  EXPECT_NEAR(frequencies(string)[0] / hz, 1, 1e-6);
  cable.tension.reset();
  cable.stretch = 2.4 * 0.02 / 1.02;
  EXPECT_NEAR(frequencies(string)[0] / hz, 1, 1e-6);
  const Scene again = parse_scene(scene_text(string), "again.toml");
  EXPECT_EQ(again.members[0].mass_of, Member::MassOf::installed);
}

}  // namespace rigfit::model::actual_state_test
