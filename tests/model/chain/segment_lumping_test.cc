#include "model/chain/segment_lumping.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "model/linear/modal_analysis.h"
#include "model/scene/model_reduction.h"
#include "tests/model/test_scenes.h"
#include "tests/reference/closed_forms.h"

namespace rigfit::model::segment_lumping_test {
namespace {

TEST(SegmentLumping, ClampIsGregorysRuleWithoutTension) {
  const ClampFlexibility none = clamp_flexibility(0);
  EXPECT_EQ(none.end, 3.0 / 8);
  EXPECT_EQ(1 + none.next, 7.0 / 6);
  EXPECT_EQ(1 + none.second, 23.0 / 24);
  // Continuous there: of first order in q for the end, of second for the others.
  for (const double q : {1e-7, 1e-4, 1e-2}) {
    const ClampFlexibility little = clamp_flexibility(q * q);
    EXPECT_NEAR(little.end, none.end, q);
    EXPECT_NEAR(little.next, none.next, q * q + 1e-15);
    EXPECT_NEAR(little.second, none.second, q * q + 1e-15);
  }
  // From one way of evaluating to the other.
  for (const double q : {0.1, 2 * std::sinh(0.5)}) {
    const double below = clamp_flexibility(q * q * (1 - 1e-9)).end;
    const double above = clamp_flexibility(q * q * (1 + 1e-9)).end;
    EXPECT_NEAR(below, above, 1e-9);
  }
}

// Moments of a chain under tension, by the recurrence of its joints from the far end to the clamp:
// the straight part it is asymptotic to must be the beam's, slope times (x - sqrt(EI / T)).
TEST(SegmentLumping, ClampPutsTheLayersFarSideWhereTheBeamIs) {
  for (const double q : {0.05, 0.3, 1.0, 1.455, 4.0, 20.0}) {
    const ClampFlexibility clamp = clamp_flexibility(q * q);
    ASSERT_GT(clamp.end, 0) << q;
    ASSERT_GT(1 + clamp.second, 0) << q;
    // Unit of length: the segment; of force: T. M_(i+1) - M_i = phi_(i+1) - slope, phi_(i+1) -
    // phi_i = q^2 f_i M_i, and M decays.
    const double p = 2 * std::asinh(q / 2);
    double m_2 = 1, m_3 = std::exp(-p);
    const double m_1 = (2 + q * q * (1 + clamp.second)) * m_2 - m_3;
    const double m_0 = (2 + q * q * (1 + clamp.next)) * m_1 - m_2;
    // phi_1 = q^2 f_0 M_0 and the slope follow; the offset of the straight part is -M_0.
    const double slope = q * q * clamp.end * m_0 - (m_1 - m_0);
    EXPECT_NEAR(m_0 / slope, 1 / q, 1e-12 / (q * q)) << q;
  }
}

TEST(SegmentLumping, NominalTensionIsTheEquilibriums) {
  for (const double tension : {5.0, 25.0, 200.0}) {
    Scene scene = testing::paper_cable(tension, 0);  // bending would carry a part
    ModesOptions options;
    options.count = 1;
    options.error_estimate = false;
    const auto rest = analyse_modes(scene, options).equilibrium.members[0];
    Member member = scene.members[0];
    EXPECT_EQ(nominal_tension(member, 2.4, 1, 1.6), tension);
    member.tension.reset();
    member.unstretched_length = rest.unstretched_length_m;
    // Parabola's length against the chain's: (w L / T)^2 / 40 relative, and the chain's n^-2.
    const double w = 0.16667 * kStandardGravity, slope = w * 2.4 / tension;
    EXPECT_NEAR(nominal_tension(member, 2.4, 1, w) / tension, 1, 0.1 * slope * slope + 4e-3);
  }
}

/// Largest error of the first `count` frequencies of a plane.
double worst(Scene scene, const std::vector<double>& truth, int n) {
  ModesOptions options;
  options.count = 2 * int(truth.size());
  options.segments = n;
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

}  // namespace
}  // namespace rigfit::model::segment_lumping_test
