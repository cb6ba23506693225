// Against differences of FRFs synthesised anew: another equilibrium, other equations, other modes.
#include "model/frfs/frf_synthesis.h"

#include "model/scene/scene.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::frf_sensitivities_test {

/// Largest |rate - differences| over the largest |rate| of all lines, sensors and loads.
void expect_differences(const Scene& scene, const std::vector<std::string>& names,
                        const Eigen::VectorXd& lines, double relative_step, double tolerance,
                        double window = 0) {
  const FrfSensitivities found =
      synthesize_frf_sensitivities(scene, lines, parameters_named(scene, names), {}, window);
  ASSERT_EQ(found.frfs.equilibrium.status, EquilibriumStatus::converged);
  const SynthesizedFrfs plain = synthesize_frfs(scene, lines, {}, window);
  for (std::size_t k = 0; k < plain.H.size(); ++k) {
    EXPECT_LT((found.frfs.H[k] - plain.H[k]).norm(), 1e-12 * plain.H[k].norm());
  }
  ASSERT_EQ(found.rate.size(), names.size());
  for (std::size_t p = 0; p < names.size(); ++p) {
    const double value = parameter(scene, names[p]);
    const double h = value != 0 ? relative_step * std::abs(value) : 10 * relative_step;
    const auto at = [&](double x) {
      Scene moved = scene;
      set_parameter(moved, names[p], x);
      return synthesize_frfs(moved, lines, {}, window).H;
    };
    const auto up = at(value + h), down = at(value - h), up2 = at(value + 2 * h),
               down2 = at(value - 2 * h);
    double largest = 0, worst = 0;
    for (std::size_t k = 0; k < up.size(); ++k) {
      const Eigen::MatrixXcd expected = (8.0 * (up[k] - down[k]) - (up2[k] - down2[k])) / (12 * h);
      largest = std::max(largest, expected.cwiseAbs().maxCoeff());
      worst = std::max(worst, (found.rate[p][k] - expected).cwiseAbs().maxCoeff());
    }
    EXPECT_GT(largest, 0) << names[p];
    EXPECT_LT(worst, tolerance * largest) << names[p] << ": " << worst / largest;
  }
}

Scene cable(double tension) {
  Scene scene = testing::paper_cable(tension, 0.4, 14);
  scene.members[0].damping_ratio = 0.02;
  scene.loads = {testing::impact({"", "cable", 0.3}, {0, 0.8, 0.6}, 0, 0),
                 testing::impact({"", "cable", 0.6}, {0, 1, 0}, 0, 0, "second")};
  scene.sensors.push_back({"quarter", {"", "cable", 0.25}, {0, 1, 0}, {}});
  scene.sensors.push_back({"out", {"", "cable", 0.45}, {0, 0, 1}, Sensor::Quantity::velocity});
  scene.sensors.push_back({"pull", {"", "cable", 0.5}, {1, 0, 0}, Sensor::Quantity::force});
  return scene;
}

// Fourth-order differences at a relative step of 1e-4: a resonance of ratio 0.02 has its scale at
// 4 % of p, (1e-4 / 0.04)^4 = 4e-11; the eigenvalues' 1e-10 over the step gives 1e-6, and central
// differences of assembled forces, of a path straight to first order, about 1e-5 of the rate.
TEST(FrfSensitivities, OfASaggingCableWithModalDamping) {
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(30, 1, 23);
  for (const double tension : {25.0, 200.0}) {
    SCOPED_TRACE(tension);
    expect_differences(cable(tension),
                       {"cable.tension", "cable.EA", "cable.EI", "cable.mass_per_length",
                        "cable.damping_ratio", "right.x", "right.y"},
                       lines, 1e-4, 5e-5);
  }
}

TEST(FrfSensitivities, OfTheRigWithDifferentRatiosAndEqualCables) {
  // Equal cables on both sides of the beam: modes pairwise close, damped spaces turn quickly.
  Scene scene = testing::cable_beam_rig(100, 0.4948, 8);
  scene.members[0].damping_ratio = 0.03;
  scene.members[1].damping_ratio = scene.members[2].damping_ratio = 0.02;
  scene.loads = {testing::impact({"", "beam", 0.8}, {1, 0, 0}, 0, 0)};
  scene.sensors.push_back({"beam", {"", "beam", 0.6}, {1, 0, 0}, {}});
  scene.sensors.push_back({"left", {"", "left cable", 0.5}, {0, 1, 0}, {}});
  expect_differences(scene,
                     {"beam.EI_z", "beam.mass_per_length", "left cable.tension",
                      "beam.damping_ratio", "left cable.damping_ratio", "tip.mass"},
                     Eigen::VectorXd::LinSpaced(25, 2, 30), 1e-4, 1e-4);
  // The stiffness that is hardly felt wants a wider step for the same 1e-10.
  expect_differences(scene, {"right cable.EA"}, Eigen::VectorXd::LinSpaced(25, 2, 30), 1e-2, 1e-4);
}

TEST(FrfSensitivities, OfJointDampersAndElasticSupports) {
  Scene scene = cable(100);
  scene.members[0].damping_ratio.reset();
  scene.members[0].damping = {200, 0.02, 0};
  scene.members[0].tension.reset();
  scene.members[0].stretch = 0.002;
  scene.nodes[0].support.kind = Support::Kind::elastic;
  scene.nodes[0].support.translational << 2e5, 3e4, 4e4;
  scene.nodes[0].support.rotational << 1, 5, 4;
  expect_differences(scene,
                     {"cable.stretch", "left.translational_x", "left.translational_y",
                      "left.rotational_z", "cable.damping_bending", "cable.damping_axial"},
                     Eigen::VectorXd::LinSpaced(25, 1, 40), 1e-4, 5e-5, 2);
}

TEST(FrfSensitivities, OfANodeMovedOutOfThePlane) {
  // The scene loses its plane of symmetry: the motion in the plane drives the one out of it.
  Scene scene = testing::cable_beam_rig(100, 0.4948, 8);
  for (auto& member : scene.members) member.damping = {200, 2e-2, 1e-3};
  scene.loads = {testing::impact({"", "beam", 0.8}, {1, 0, 0}, 0, 0)};
  scene.sensors.push_back({"out", {"", "left cable", 0.5}, {0, 0, 1}, {}});
  scene.sensors.push_back({"in", {"", "left cable", 0.5}, {0, 1, 0}, {}});
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(10, 3, 25);
  const FrfSensitivities found =
      synthesize_frf_sensitivities(scene, lines, parameters_named(scene, {"left.z"}));
  double in = 0, out = 0;
  for (const auto& rate : found.rate[0]) {
    out = std::max(out, std::abs(rate(0, 0)));
    in = std::max(in, std::abs(rate(1, 0)));
  }
  EXPECT_GT(out, 0);
  // The response in the plane is even in z: what rounding leaves of the difference.
  EXPECT_LT(in, 1e-4 * out);
  // Differences over another step: second order in z over the cable's 1.2 m, and the solvers'
  // 1e-10 over 1e-3.
  expect_differences(scene, {"left.z"}, lines, 1e-4, 2e-3);
}

TEST(FrfSensitivities, NamesAnUnknownParameter) {
  EXPECT_THROW((void)parameters_named(cable(200), {"EI"}), SceneError);
}

}  // namespace rigfit::model::frf_sensitivities_test
