#include "model/chain/segment_lumping.h"

#include "model/linear/modal_analysis.h"
#include "model/scene/model_reduction.h"
#include "tests/reference/closed_forms.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::segment_lumping_test {

/// Largest error of the first `count` frequencies of a plane.
double worst(Scene scene, const std::vector<double>& truth, int n) {
  ModesOptions options{.count = 2 * int(truth.size()), .segments = n};
  options.error_estimate = false;
  scene.gravity.setZero();
  const ModalAnalysis analysis = analyse_modes(scene, options);
  double largest = 0;
  for (std::size_t i = 0; i < analysis.modes.size(); ++i) {
    largest = std::max(largest, std::abs(analysis.modes[i].frequency_hz / truth[i / 2] - 1));
  }
  return largest;
}

TEST(SegmentLumping, ClampedEndsCostLittle) {
  // The clamped 200 N cable, whose layers of 55 mm are shorter than a segment of 80: a plain joint
  // with half a segment errs by 9e-3.
  Scene cable = testing::paper_cable(200, 0.5972);
  for (auto& node : cable.nodes) node.support.kind = Support::Kind::clamped;
  const double e = 200 / 221780.0;
  const auto taut = clamped_beam_frequencies({2.4, 0.16667 / (1 + e), 0.5972 * (1 + e), 200}, 1);
  EXPECT_LT(worst(cable, taut, 30), 1e-4);
  // Second order: 1/4 for twice as many, to the fourth-order rest.
  EXPECT_NEAR(worst(cable, taut, 60) / worst(cable, taut, 120), 4, 0.4);

  // A cantilever errs by the fourth order: (kl)^4 / 720 or less of each mode.
  const Scene beam = testing::vertical_beam(0.75, 2.1, 0.295);
  const auto truth = cantilever_frequencies({0.75, 0.295, 2.1, 0}, 0, 2);
  EXPECT_LT(worst(beam, truth, 30), 1e-6);
  EXPECT_GT(worst(beam, truth, 10) / worst(beam, truth, 20), 12);
}

TEST(SegmentLumping, AxialForceOfABeamIsWhatItBears) {
  Scene rig = testing::cable_beam_rig(100, 0.4948);
  auto ends = member_nodes(rig);
  const double g = kStandardGravity, cables = 2 * 0.5 * 1.2 * 0.16667;
  AxialForce force = nominal_axial_force(rig, ends, 0);
  EXPECT_NEAR(force.second, -(0.02 + cables) * g, 1e-12);  // level cables that pull alike
  EXPECT_NEAR(force.first, -(0.02 + cables + 0.75 * 0.295) * g, 1e-12);
  EXPECT_EQ(nominal_axial_force(rig, ends, 1).first, 0);  // a cable has its tension
  // Guys to the ground press: 100 N level is 100 sqrt(2) along 45 degrees, 100 down each.
  for (std::size_t k : {2U, 3U}) rig.nodes[k].position << (k == 2 ? -0.75 : 0.75), 0, 0;
  rig.gravity *= 1e-6;
  EXPECT_NEAR(nominal_axial_force(rig, ends, 0).at(0.5), -200, 1e-3);
  // Hanging from its foot it is pulled; drawn the other way round the ends change places.
  Scene hanging = testing::vertical_beam(0.75, 2.1, 0.295);
  hanging.gravity = -hanging.gravity;
  hanging.members[0].nodes = {"tip", "base"};
  force = nominal_axial_force(hanging, member_nodes(hanging), 0);
  EXPECT_NEAR(force.second, 0.75 * 0.295 * g, 1e-12);
  EXPECT_NEAR(force.first, 0, 1e-12);
}

}  // namespace rigfit::model::segment_lumping_test
