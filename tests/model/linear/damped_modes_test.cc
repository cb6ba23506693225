#include "model/linear/damped_modes.h"

#include "model/algebra/eigenpairs.h"
#include "model/linear/modal_analysis.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::damped_modes_test {

/// Poles of the whole quadratic problem, dense; the unknowns without inertia are condensed first.
std::vector<Complex> dense_poles(const MotionModes& motion, const ChainState& state) {
  EnvelopeMatrix c = motion.assembly->matrix();
  motion.assembly->damping(state, c);
  const Eigen::MatrixXd k = motion.stiffness.sparse(), m = motion.mass.sparse(), d = c.sparse();
  // s (C s + K) ... as s A z = B z with z = (u, s u): A = [C M; M 0], B = [-K 0; 0 M].
  const auto n = k.rows();
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * n, 2 * n), b = a;
  a << d, m, m, Eigen::MatrixXd::Zero(n, n);
  b << -k, Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n), m;
  std::vector<Complex> poles;
  const Eigen::VectorXcd inverses = general_eigenpairs(b.partialPivLu().solve(a), {}).values;
  for (const auto& inverse : inverses) {  // 1 / s
    if (inverse.imag() < 0 && std::abs(inverse) > 1e-9) poles.push_back(1.0 / inverse);
  }
  std::sort(poles.begin(), poles.end(),
            [](const auto& x, const auto& y) { return std::abs(x) < std::abs(y); });
  return poles;
}

TEST(DampedModes, OfUnevenDampersAgreeWithTheDenseQuadraticProblem) {
  Scene scene = testing::paper_cable(200, 0.5972, 12);
  scene.members[0].damping = {300, 0.05, 0};
  // Uneven: a second, undamped half.
  scene.nodes.push_back(testing::node("middle", {1.2, 0, 0}));
  Member half = scene.members[0];
  half.name = "half";
  half.segments = 6;
  scene.members[0].segments = 6;
  scene.members[0].nodes[1] = "middle";
  half.nodes[0] = "middle";
  half.damping = {};
  scene.members.push_back(half);
  const ChainModes modes = find_modes(scene, {.count = 8});
  ASSERT_EQ(modes.equilibrium.status, EquilibriumStatus::converged) << modes.equilibrium.reason;
  for (const MotionModes& motion : modes.motions) {
    if (motion.motion == Motion::out_of_plane) continue;  // its mass matrix is singular in rotation
    const Eigen::VectorXcd poles = damped_poles(motion, modes.equilibrium.state, scene);
    std::vector<Complex> dense;
    {
      // Regularised: a rotation's inertia so small that it moves the poles by less than 1e-9.
      MotionModes copy{{motion.motion, std::make_unique<Assembly>(*modes.chain, motion.motion),
                        motion.stiffness},
                       motion.mass};
      for (int i = 0; i < copy.mass.size(); ++i) {
        if (copy.mass.at(i, i) == 0) copy.mass.add(i, i, 1e-12);
      }
      dense = dense_poles(copy, modes.equilibrium.state);
    }
    for (Index i = 0; i < poles.size(); ++i) {
      const auto nearest =
          *std::min_element(dense.begin(), dense.end(), [&](const auto& x, const auto& y) {
            return std::abs(x - poles[i]) < std::abs(y - poles[i]);
          });
      EXPECT_LT(std::abs(nearest - poles[i]), 1e-6 * std::abs(nearest)) << i;
      EXPECT_GT(damping_ratio_of(poles[i]), 1e-6);
    }
  }
}

TEST(DampedModes, StiffnessProportionalDampersGiveTheClosedForm) {
  // Dampers of b times the springs everywhere: zeta = b (omega_elastic part) / 2; without tension
  // all stiffness is elastic and zeta = b omega / 2 exactly.
  Scene scene = testing::vertical_beam(0.75, 2.1, 0.295);
  scene.gravity.setZero();
  const double b = 1e-4;
  auto& beam = scene.members[0];
  beam.damping = {b * beam.EA, b * beam.EI[0], b * beam.GJ};
  const ModalAnalysis analysis = analyse_modes(scene, {.count = 6});
  for (const auto& mode : analysis.modes) {
    EXPECT_NEAR(mode.damping_ratio / (b * kPi * mode.frequency_hz), 1, 1e-8);
  }
}

TEST(DampedModes, ModalRatiosAreWeightedByStrainEnergy) {
  Scene scene = testing::cable_beam_rig(200, 0.5972);
  for (auto& member : scene.members) member.damping_ratio = 0.01;
  ModesOptions options{.count = 8};
  for (const auto& mode : analyse_modes(scene, options).modes) {
    EXPECT_NEAR(mode.damping_ratio, 0.01, 1e-12);
  }
  scene.members[0].damping_ratio = 0.03;
  for (const auto& mode : analyse_modes(scene, options).modes) {
    EXPECT_GT(mode.damping_ratio, 0.01 - 1e-12);
    EXPECT_LT(mode.damping_ratio, 0.03);
    if (mode.kinetic_energy.all[0].second < 1e-3) {
      EXPECT_LT(mode.damping_ratio, 0.012);
    }
  }
}

}  // namespace rigfit::model::damped_modes_test
