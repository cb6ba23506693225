#include "model/statics/equilibrium.h"

#include "tests/reference/closed_forms.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::equilibrium_test {

using testing::cable_beam_rig;
using testing::paper_cable;
using testing::vertical_beam;

Equilibrium rest_of(const Scene& scene) {
  Chain chain = Chain::from_scene(scene);
  const ChainEquilibrium found = find_equilibrium(chain, scene);
  return describe(chain, found, scene);
}

/// All that the scene asks for, from a cold start: tension 0.5 N to 10 kN, EA 100 times smaller and
/// larger, EI from 0 to 15.6 N m2, level to 80 degrees, pinned as it hangs and clamped straight.
TEST(Equilibrium, IsFoundFromAColdStartOverTheWholeRange) {
  int states = 0;
  for (const double tension : {0.5, 1.0, 5.0, 25.0, 100.0, 300.0, 10000.0}) {
    for (const double EA : {2217.8, 221780.0, 22178000.0}) {
      for (const double EI : {0.0, 0.2549, 15.6}) {
        for (const double degrees : {0.0, 30.0, 80.0}) {
          for (const bool clamped : {false, true}) {
            Scene scene = paper_cable(tension, EI);
            scene.members[0].EA = EA;
            const double angle = degrees * kPi / 180;
            scene.nodes[1].position << 2.4 * std::cos(angle), 2.4 * std::sin(angle), 0;
            if (clamped) {
              scene.members[0].assembled = Member::Assembled::straight;
              for (auto& node : scene.nodes) node.support.kind = Support::Kind::clamped;
            }
            const Equilibrium rest = rest_of(scene);
            ASSERT_EQ(rest.status, EquilibriumStatus::converged)
                << tension << " N, EA " << EA << ", EI " << EI << ", " << degrees << " degrees, "
                << (clamped ? "clamped: " : "pinned: ") << rest.reason;
            // Residual: 1e-9, or what rounding of positions makes of EA / l: 16 eps (as accepted)
            // times 30 segments times twice the span over the span.
            EXPECT_LT(rest.residual, 1e-9 + 16 * 2.2e-16 * 30 * 2 * 1.1 * EA / tension);
            EXPECT_NEAR(rest.members[0].tension_N, tension, 1e-7 * tension + 1e-13 * EA);
            ++states;
          }
        }
      }
    }
  }
  EXPECT_EQ(states, 7 * 3 * 3 * 3 * 2);
}

TEST(Equilibrium, ThreeWaysOfGivingTheTensionAgree) {
  Scene scene = paper_cable(25, 0.2549);
  const Equilibrium by_tension = rest_of(scene);
  const double length = by_tension.members[0].unstretched_length_m;
  scene.members[0].tension.reset();
  scene.members[0].unstretched_length = length;
  const Equilibrium by_length = rest_of(scene);
  ASSERT_EQ(by_length.status, EquilibriumStatus::converged) << by_length.reason;
  // dT/dL is about EA / L near taut states, rounding of L 1e-16: far below 1e-7.
  EXPECT_NEAR(by_length.members[0].tension_N, 25, 1e-7);
  scene.members[0].unstretched_length.reset();
  scene.members[0].stretch = 2.4 - length;
  EXPECT_NEAR(rest_of(scene).members[0].tension_N, 25, 1e-7);
}

TEST(Equilibrium, ClampedBeamSagsAsTheClosedFormSays) {
  // Horizontal cantilever, w L^4 / (8 EI) with a small load: second order in the segment length,
  // extrapolated; geometric non-linearity is (sag / L)^2, here 1e-9.
  double sag[2];
  for (int k = 0; k < 2; ++k) {
    Scene scene = vertical_beam(0.75, 210, 0.01, k == 0 ? 30 : 60);
    scene.gravity << 0.2, 0, 0;
    const Equilibrium rest = rest_of(scene);
    ASSERT_EQ(rest.status, EquilibriumStatus::converged);
    sag[k] = std::abs(rest.members[0].positions(0, k == 0 ? 30 : 60));
  }
  const double truth = 0.01 * 0.2 * std::pow(0.75, 4) / (8 * 210);
  EXPECT_NEAR((4 * sag[1] - sag[0]) / 3 / truth, 1, 2e-6);
}

TEST(Equilibrium, RigRestsWithBothTensions) {
  const Equilibrium rest = rest_of(cable_beam_rig(25, 0.2549));
  ASSERT_EQ(rest.status, EquilibriumStatus::converged) << rest.reason;
  EXPECT_NEAR(rest.members[1].tension_N, 25, 1e-6);
  EXPECT_NEAR(rest.members[2].tension_N, 25, 1e-6);
  EXPECT_LT(rest.residual, 1e-8);
}

}  // namespace rigfit::model::equilibrium_test
