#include "model/motion/stiff_motion.h"

#include "model/response/response.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::stiff_motion_test {

// A rig struck across its plane: torsion and a node that turns in space. What the formulas damp
// falls with the tolerance, and so does what the samples change by.
TEST(StiffMotion, ConvergesInSpaceWithTorsionAndTurningNodes) {
  Scene scene = testing::beam_and_cables(5);
  scene.members[0].GJ = 1.5;
  scene.loads[0].direction = {0.6, 0, 0.8};
  scene.loads[0].peak = 100;
  ResponseOptions options{.solver = ResponseSolver::stiff_motion, .space = true};
  options.sampling = {.duration_s = 0.1, .rate_hz = 2000};
  double drift[3];
  Eigen::MatrixXd samples[3];
  for (int k = 0; k < 3; ++k) {
    options.relative_tolerance = std::pow(10.0, -5 - k);
    const ResponseResult out = simulate_response(scene, options);
    ASSERT_TRUE(out.completed) << out.reason;
    drift[k] = out.energy_drift;
    samples[k] = out.samples;
  }
  EXPECT_LT(drift[2], 1e-4);
  EXPECT_LT(drift[2], 0.3 * drift[0]);
  const double size = samples[2].norm();
  EXPECT_LT((samples[1] - samples[2]).norm(), 1e-3 * size);
  EXPECT_LT((samples[1] - samples[2]).norm(), 0.5 * (samples[0] - samples[2]).norm());
}

// A free beam that spins through every direction, with torsion: the rates of increments are not
// those of angles there. Its energy stays, and its sum of momenta.
TEST(StiffMotion, CountsIncrementsAnewWhereAChainTurnsFar) {
  Scene scene = testing::span(testing::member(Member::Kind::beam, "beam", "", "", 4, 0.3, 2e3, 0.6),
                              testing::node("a", {0, 0, 0}), testing::node("b", {1, 0, 0}));
  scene.gravity.setZero();
  scene.members[0].EI[1] = 1.2;
  scene.members[0].GJ = 0.5;
  scene.members[0].polar_inertia = 1e-4;
  Chain chain = Chain::from_scene(scene, {.torsion = true});
  chain.settled = true;
  MotionProblem problem{.chain = &chain, .motion = Motion::space};
  problem.rest = problem.start = drawn_state(chain);
  const Assembly assembly(chain, Motion::space);
  problem.start_velocity.setZero(assembly.size());
  for (int k = 0; k < chain.nodes; ++k) {
    const Eigen::Vector3d x = problem.start.position.col(k);
    const Eigen::Vector3d v = Eigen::Vector3d(0.5, 3, 10).cross(x) + Eigen::Vector3d(0.2, -1, 0.3);
    for (int axis = 0; axis < 3; ++axis) {
      problem.start_velocity(assembly.numbering().displacement(axis, k)) = v[axis];
    }
  }
  StiffOptions run;
  run.sampling = {.duration_s = 2, .rate_hz = 50};
  run.relative_tolerance = 1e-8;
  run.displacement_m = 1;
  run.velocity_m_s = 5;
  const MotionOutput out = stiff_motion(problem, run);
  ASSERT_TRUE(out.completed) << out.reason;
  EXPECT_LT(out.energy.drift(), 1e-4);
}

}  // namespace rigfit::model::stiff_motion_test
