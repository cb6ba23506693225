// Supports' springs from 0 to 1e15 N/m (N m/rad): they are solved, and as they grow the rig becomes
// that of fixed supports.
#include "model/linear/modal_analysis.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::stiff_springs_test {

Scene cable(double length, double mass_per_length, double EA, double EI, double tension) {
  Member member =
      testing::member(Member::Kind::cable, "cable", "", "", 20, mass_per_length, EA, EI);
  member.GJ = EI;
  member.tension = tension;
  return testing::span(member, testing::node("a", {0, 0, 0}, Support::Kind::pinned),
                       testing::node("b", {length, 0, 0}, Support::Kind::pinned));
}

void spring(SceneNode& node, const Eigen::Vector3d& translational,
            const Eigen::Vector3d& rotational) {
  node.support.kind = Support::Kind::elastic;
  node.support.translational = translational, node.support.rotational = rotational;
}

ModalAnalysis modes_of(const Scene& scene) { return analyse_modes(scene, {.count = 4}); }

// A spring in series with the cable gives way by T / k and takes the part (EA/L) / k from its axial
// stiffness: relative changes of a frequency of that order, and of 1/(k n^2 ...) smaller ones
// across. Ten times the sum of both, and the eigenvalues' own accuracy of 1e-9.
TEST(StiffSprings, TendToFixedSupports) {
  const double L = 2.4, EA = 221780, T = 200;
  Scene fixed = cable(L, 0.16667, EA, 0.6, T);
  for (auto& node : fixed.nodes) node.support.kind = Support::Kind::clamped;
  const auto reference = modes_of(fixed);
  ASSERT_EQ(reference.equilibrium.status, EquilibriumStatus::converged);
  for (double k = 1e7; k <= 1.1e15; k *= 10) {
    Scene scene = fixed;
    for (auto& node : scene.nodes) {
      spring(node, Eigen::Vector3d::Constant(k), Eigen::Vector3d::Constant(k));
    }
    const auto found = modes_of(scene);
    ASSERT_EQ(found.equilibrium.status, EquilibriumStatus::converged) << k;
    EXPECT_NEAR(found.equilibrium.members[0].tension_N, T, 1e-6 * T) << k;
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(found.modes[i].frequency_hz / reference.modes[i].frequency_hz, 1,
                  10 * EA / L / k + 1e-9)
          << k << " mode " << i + 1;
    }
  }
}

// A bar on two springs k along its axis: it moves as a whole at sqrt(2 k / M) when they are soft.
TEST(StiffSprings, SoftOnesCarryTheRigAsAWhole) {
  Scene scene = cable(2, 3, 1e6, 50, 100);
  scene.gravity.setZero();
  scene.members[0].kind = Member::Kind::beam;
  scene.members[0].tension.reset();
  for (auto& node : scene.nodes) spring(node, {30, 1e12, 1e12}, {1e12, 1e12, 1e12});
  const auto found = modes_of(scene);
  ASSERT_EQ(found.equilibrium.status, EquilibriumStatus::converged) << found.equilibrium.reason;
  // Its own axial compliance L / EA is 2e-6 of 1 / k.
  EXPECT_NEAR(found.modes[0].frequency_hz, std::sqrt(60.0 / 6) / (2 * kPi), 1e-4);
}

TEST(StiffSprings, RandomScenesAreSolved) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform;
  const auto decades = [&](double low, double high) {
    return std::pow(10.0, low + (high - low) * uniform(random));
  };
  for (int i = 0; i < 60; ++i) {
    const double L = decades(-0.3, 2), m = decades(-1.5, 1.3);
    const double T = m * 9.81 * L * decades(0, 2.5);
    Scene scene = cable(L, m, T * decades(1.3, 4), T * L * L * decades(-6, -2), T);
    for (auto& node : scene.nodes) {
      if (uniform(random) < 0.3) continue;
      // Such that the tension moves an end by 2 % of the length at most.
      const double least = std::log10(T / (0.02 * L));
      Eigen::Vector3d translational, rotational;
      for (int axis = 0; axis < 3; ++axis) {
        translational[axis] = decades(least, std::max(least, 15.0));
        rotational[axis] = uniform(random) < 0.3 ? 0 : decades(-2, 15);
      }
      rotational[0] = decades(0, 15);  // holds the twist
      spring(node, translational, rotational);
    }
    const auto found = modes_of(scene);
    ASSERT_EQ(found.equilibrium.status, EquilibriumStatus::converged)
        << i << ": " << found.equilibrium.reason;
    EXPECT_NEAR(found.equilibrium.members[0].tension_N, T, 1e-6 * T) << i;
    for (const auto& mode : found.modes) {
      EXPECT_TRUE(std::isfinite(mode.frequency_hz) && mode.frequency_hz > 0) << i;
    }
  }
}

}  // namespace rigfit::model::stiff_springs_test
