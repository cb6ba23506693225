#include "model/motion/explicit_motion.h"

#include "model/motion/motion_kernel.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::explicit_motion_test {

using testing::node;
using testing::sensor;

// A chain let go as drawn: no equilibrium is needed, gravity and springs move it.
MotionProblem let_go(const Chain& chain, const Scene& scene, Motion motion) {
  MotionProblem problem{.chain = &chain, .motion = motion};
  problem.rest = problem.start = drawn_state(chain);
  for (const Load& load : scene.loads) problem.loads.push_back({load});
  for (const Sensor& s : scene.sensors) problem.quantities.push_back(s.quantity);
  return problem;
}

Chain settled(const Scene& scene, const ChainOptions& options = {}) {
  Chain chain = Chain::from_scene(scene, options);
  chain.settled = true;
  return chain;
}

// A soft cable, stretched straight by 5 %, that falls into its sag: large motion, all stiffnesses.
Scene falling_cable(int segments) {
  Scene scene = testing::released_cable(segments);
  scene.members[0].EA = 300;
  scene.members[0].tension.reset();
  scene.members[0].stretch = 0.05 * 2.4;
  scene.loads.clear();
  return scene;
}

// 1 m long, held by nothing.
Scene free_rod(const Member& member) {
  Scene scene = testing::span(member, node("a", {0, 0, 0}), node("b", {1, 0, 0}));
  scene.gravity.setZero();
  return scene;
}

Eigen::MatrixXd response(const MotionProblem& problem, double duration, double step) {
  ExplicitOptions options;
  options.sampling = {.duration_s = duration, .rate_hz = 200};
  options.step_s = step;
  const MotionOutput out = explicit_motion(problem, options);
  EXPECT_TRUE(out.completed) << out.reason;
  return out.samples;
}

TEST(ExplicitMotion, ConvergesWithFourthOrder) {
  const Scene scene = falling_cable(8);
  const Chain chain = settled(scene);
  const MotionProblem problem = let_go(chain, scene, Motion::in_plane);
  // Halving the steps from 0.25 ms on divides the errors by 16.0; at 0.5 ms the highest
  // modes are not yet resolved. The reference's own error is (1/8)^4 of the finer one's.
  const Eigen::MatrixXd truth = response(problem, 0.5, 0.000015625);
  const auto error = [&](double step) {
    return (response(problem, 0.5, step) - truth).col(0).norm();
  };
  const double coarse = error(0.00025), middle = error(0.000125);
  EXPECT_GT(coarse / middle, 12);
  EXPECT_LT(coarse / middle, 22);
}

// A stiff rod of two segments, pinned at the origin, let go level: it swings through 180 degrees
// and past the vertical, where Euler angles are singular. omega(theta)^2 = 3 g sin(theta) / l for
// the fall by theta; the period is that of a pendulum with an amplitude of 90 degrees, T = 4
// K(1/sqrt 2) / sqrt(3 g / (2 l)).
TEST(ExplicitMotion, RodSwingsThroughTheVertical) {
  // Stretches and bends by parts in 1e4, at frequencies far above the swing's.
  Scene scene =
      testing::span(testing::member(Member::Kind::beam, "rod", "", "", 2, 2, 1e6, 1e4),
                    node("pivot", {0, 0, 0}, Support::Kind::pinned), node("end", {1, 0, 0}));
  Sensor end{
      .place = {.node = "end"}, .direction = {1, 0, 0}, .quantity = Sensor::Quantity::displacement};
  scene.sensors = {end};
  const Chain chain = settled(scene, {.rotary_inertia = RotaryInertia::rigid_rod});
  const double period =
      4 * std::comp_ellint_1(std::numbers::sqrt2 / 2) / std::sqrt(1.5 * kStandardGravity);
  for (Motion motion : {Motion::in_plane, Motion::space}) {
    const MotionProblem problem = let_go(chain, scene, motion);
    ExplicitOptions run;
    // 20 samples a period, over three periods: back level at every twentieth.
    run.sampling = {.duration_s = 3 * period, .rate_hz = 20 / period};
    const MotionOutput out = explicit_motion(problem, run);
    ASSERT_TRUE(out.completed);
    for (int n : {20, 40, 60}) EXPECT_NEAR(out.samples(n, 0), 0, 2e-4) << n;
    for (int n : {10, 30, 50}) EXPECT_NEAR(out.samples(n, 0), -2, 2e-4) << n;
    // A stiff direction that turns: (Omega h)^2 with Omega = 5.4 rad/s at the bottom, h = 0.65 ms.
    EXPECT_LT(out.energy.drift(), 1.2e-5);
  }
}

TEST(ExplicitMotion, EnergyAccountClosesUnderALoad) {
  Scene scene = testing::beam_and_cables(6);
  for (Member& member : scene.members) {
    if (member.kind == Member::Kind::cable) {
      member.tension.reset();
      member.stretch = 0.002;
      member.EA = 2e4;
    }
  }
  scene.loads[0].peak = 200;
  scene.loads[0].start = 0.01;
  const Chain chain = settled(scene);
  const MotionProblem problem = let_go(chain, scene, Motion::in_plane);
  ExplicitOptions run;
  run.sampling = {.duration_s = 0.5, .rate_hz = 2000};
  const MotionOutput out = explicit_motion(problem, run);
  ASSERT_TRUE(out.completed) << out.reason;
  // Fourth order at omega h = 3.2 for the highest axial mode, which hardly moves.
  EXPECT_LT(out.energy.drift(), 1e-4);
  EXPECT_GT(out.energy.supplied, 0.1);
}

TEST(ExplicitMotion, PulseGivesItsImpulseWhateverTheStep) {
  // A free rod, no gravity: after the pulse it moves at 2 P D/(pi m), however the steps lie.
  Scene scene = free_rod(testing::member(Member::Kind::beam, "rod", "", "", 2, 2, 1e3, 10));
  Load load = testing::impact({"", "rod", 0.5}, {0, 1, 0}, 7, 0.013);
  Sensor centre = sensor("rod", 0.5, Sensor::Quantity::velocity);
  scene.sensors = {centre, sensor("rod", 0, Sensor::Quantity::velocity)};
  for (double start : {0.0, 0.0137}) {
    load.start = start;
    scene.loads = {load};
    const Chain chain = settled(scene);
    const MotionProblem problem = let_go(chain, scene, Motion::in_plane);
    ExplicitOptions run;
    run.sampling = {.duration_s = 0.1, .rate_hz = 500};
    run.step_s = 0.002;
    const MotionOutput out = explicit_motion(problem, run);
    ASSERT_TRUE(out.completed);
    const double expected = 2 * load.peak * load.duration / kPi / 2.0;
    EXPECT_GT(out.energy.kinetic, expected * expected * 2 / 2 * 0.99);
    // Ends and middle about their mean: weights 1/4, 1/2, 1/4 of the mass matrix' row sums.
    EXPECT_NEAR((out.samples(50, 0) + out.samples(50, 1)) / 2, expected, 1e-5 * expected);
  }
}

}  // namespace rigfit::model::explicit_motion_test
