// Against differences of the whole analysis: another equilibrium, another eigenvalue problem.
#include "model/linear/modal_analysis.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::sensitivities_test {

/// `relative_step` of the differences: where the rig hardly feels a number, its equilibria and
/// eigenvalues (1e-9) want a larger one; where it moves by millimetres, a smaller one.
void expect_differences(const Scene& scene, const std::vector<std::string>& names, int count,
                        double relative_step = 1e-3) {
  ModesOptions options{.count = count, .error_estimate = false};
  const ModeSensitivities found = analyse_mode_sensitivities(scene, names, options);
  ASSERT_EQ(found.analysis.equilibrium.status, EquilibriumStatus::converged);
  for (std::size_t p = 0; p < names.size(); ++p) {
    const double value = parameter(scene, names[p]);
    const double h = value != 0 ? relative_step * std::abs(value) : 1e-4;
    const auto at = [&](double x) {
      Scene moved = scene;
      set_parameter(moved, names[p], x);
      return analyse_modes(moved, options);
    };
    const ModalAnalysis up = at(value + h), down = at(value - h);
    const ModalAnalysis up2 = at(value + 2 * h), down2 = at(value - 2 * h);
    const auto rate = [&](auto quantity) {  // fourth order in h
      return (8 * (quantity(up) - quantity(down)) - (quantity(up2) - quantity(down2))) / (12 * h);
    };
    for (int i = 0; i < count; ++i) {
      const auto k = std::size_t(i);
      const double f = found.analysis.modes[k].frequency_hz;
      const auto frequency = [&](const ModalAnalysis& a) { return a.modes[k].frequency_hz; };
      const double expected = rate(frequency);
      // Differences: eigenvalues to 1e-10, divided by the step of 1e-3; central differences of the
      // matrices: 1e-8 and what rounding of K leaves, 1e-6.
      EXPECT_NEAR(found.frequency(i, Index(p)), expected,
                  2e-5 * std::abs(expected) + 1e-6 * f / std::max(std::abs(value), 0.1))
          << names[p] << ", mode " << i;
      const auto damping = [&](const ModalAnalysis& a) { return a.modes[k].damping_ratio; };
      EXPECT_NEAR(found.damping_ratio(i, Index(p)), rate(damping),
                  1e-4 * std::abs(rate(damping)) + 1e-7 / std::max(std::abs(value), 0.1))
          << names[p] << ", mode " << i;
    }
  }
}

TEST(ModeSensitivities, OfASaggingCable) {
  Scene scene = testing::paper_cable(25, 0.2549, 16);
  scene.members[0].damping_ratio = 0.005;
  scene.members[0].masses = {{0.3, 0.01}};
  expect_differences(scene,
                     {"cable.tension", "cable.EA", "cable.EI", "cable.mass_per_length",
                      "cable.damping_ratio", "cable.masses1.mass", "right.x", "right.y"},
                     5);
}

TEST(ModeSensitivities, OfTheRigWithJointDampers) {
  Scene scene = testing::cable_beam_rig(100, 0.4948, 10);
  scene.nodes[3].position.x() = 1.27;  // unequal cables: no equal frequencies to swap
  for (auto& member : scene.members) member.damping = {200, 2e-3, 1e-4};
  expect_differences(
      scene,
      {"right cable.EA", "beam.EI_z", "beam.mass_per_length", "beam.damping_bending", "tip.y"}, 6);
  expect_differences(scene, {"tip.mass"}, 6, 5e-2);
}

TEST(ModeSensitivities, OfElasticSupportsAndStretch) {
  Scene scene = testing::paper_cable(100, 0.4948, 16);
  scene.members[0].tension.reset();
  scene.members[0].stretch = 0.002;
  scene.nodes[0].support.kind = Support::Kind::elastic;
  scene.nodes[0].support.translational << 2e5, 3e4, 4e4;
  scene.nodes[0].support.rotational << 1, 5, 4;
  expect_differences(
      scene, {"cable.stretch", "left.translational_x", "left.translational_y", "left.rotational_z"},
      4);
}

// Rounding of positions unbalances a stiff beam by more than a billionth of its weight.
TEST(ModeSensitivities, OfABeamThatRoundingUnbalances) {
  Scene scene = testing::vertical_beam(0.75, 2.1, 0.295, 90);
  scene.members[0].damping_ratio = 0.01;
  expect_differences(scene, {"beam.damping_ratio", "beam.mass_per_length"}, 2, 1e-2);
}

TEST(ModeSensitivities, OfTheLoadCellAndOfTemperature) {
  Scene scene = testing::paper_cable(25, 0.2549, 16);
  expect_differences(scene, {"load_cell.scale", "load_cell.zero"}, 4);
  scene.members[0].tension.reset();
  scene.members[0].stretch = 0.002;
  scene.members[0].thermal_expansion = 1.2e-5;
  scene.temperature_change = 3;
  expect_differences(scene, {"temperature_change", "cable.thermal_expansion"}, 4);
}

TEST(ModeSensitivities, OfNodesOutOfThePlane) {
  // A rig in space is like any other.
  Scene scene = testing::cable_beam_rig(100, 0.4948, 8);
  scene.nodes[3].position.x() = 1.27;
  scene.nodes[2].position.z() = 0.2;
  expect_differences(scene, {"left.z"}, 5);
  // From the plane of symmetry it leaves to either side alike: frequencies are even in z, and the
  // differences left of them are the eigenvalues' 1e-10 over the step of 1.2e-4 m.
  scene.nodes[2].position.z() = 0;
  const ModeSensitivities found =
      analyse_mode_sensitivities(scene, {"left.z"}, {.count = 5, .error_estimate = false});
  ASSERT_EQ(found.frequency.rows(), 5);
  for (Index i = 0; i < 5; ++i) {
    EXPECT_LT(std::abs(found.frequency(i, 0)), 1e-5 * found.analysis.modes[i].frequency_hz);
  }
}

/// Several numbers as one: the sum of their rates, each times its factor over the first's.
TEST(Sensitivities, OfWhatMovesTogetherAddUp) {
  Scene scene = testing::cable_beam_rig(100, 0.4948, 8);
  scene.members[0].damping_ratio = 0.01;
  const std::vector<std::string> names{"beam.EI_z", "tip.mass", "beam.damping_ratio"};
  const auto parameters = parameters_named(scene, names);
  const ModesOptions options{.count = 5, .error_estimate = false};
  const ModeSensitivities each = mode_sensitivities_by(scene, parameters, options);
  const ModeSensitivities all =
      mode_sensitivities_by(scene, {moved_together(parameters, {-200, 0.1, 1e-3})}, options);
  const Eigen::Vector3d factor(1, 0.1 / -200, 1e-3 / -200);
  EXPECT_LT((all.frequency - each.frequency * factor).norm(), 1e-6 * all.frequency.norm());
  EXPECT_LT((all.damping_ratio - each.damping_ratio * factor).norm(),
            1e-6 * all.damping_ratio.norm());
}

/// To an accuracy asked for the members' own segments say nothing, nor do masses between nodes:
/// frequencies are those of a chain of 2400 segments, rates those of differences of such chains.
TEST(Sensitivities, ToAnAskedAccuracyNeedNoSegments) {
  Scene scene = testing::paper_cable(200, 0.5972, 0);
  for (auto& node : scene.nodes) node.support.kind = Support::Kind::clamped;
  scene.members[0].masses = {{0.25, 0.02}};
  const std::vector<std::string> names{"cable.EI", "cable.tension", "cable.EA"};
  ModesOptions options;
  options.shapes = options.damped = false;
  options.accuracy = 1e-6;
  std::array<ModeSensitivities, 2> found;
  for (std::size_t k = 0; k < 2; ++k) {
    scene.members[0].segments = k == 0 ? 5 : 0;
    found[k] = analyse_mode_sensitivities(scene, names, options);
  }
  ModesOptions fine = options;
  fine.accuracy.reset();
  fine.segments = 2400;
  fine.error_estimate = false;
  const ModeSensitivities truth = analyse_mode_sensitivities(scene, names, fine);
  ASSERT_EQ(found[0].analysis.modes.size(), 6U);
  EXPECT_TRUE(found[0].analysis.extrapolated);
  EXPECT_LE(found[0].analysis.relative_error_estimate, 1e-6);
  for (Index i = 0; i < 6; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double hz = found[0].analysis.modes[k].frequency_hz;
    EXPECT_EQ(hz, found[1].analysis.modes[k].frequency_hz);
    // 2400 accurate segments err by 1.5e-7 themselves.
    EXPECT_NEAR(hz / truth.analysis.modes[k].frequency_hz, 1, 1.2e-6) << i;
    for (Index p = 0; p < 3; ++p) {
      // Derivatives with some forty segments, whose frequencies err by 1e-3.
      EXPECT_NEAR(found[0].frequency(i, p), truth.frequency(i, p),
                  0.02 * std::abs(truth.frequency(i, p)) + 1e-6 * hz)
          << i << ' ' << names[p];
    }
  }
}

}  // namespace rigfit::model::sensitivities_test
