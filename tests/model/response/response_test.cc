#include "model/response/response.h"

#include "model/motion/explicit_motion.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::response_test {

ResponseResult respond(const Scene& scene, ResponseSolver solver, double duration, double rate,
                       double tolerance = 1e-6, bool space = false) {
  ResponseOptions options;
  options.sampling = {.duration_s = duration, .rate_hz = rate};
  options.solver = solver;
  options.relative_tolerance = tolerance;
  options.space = space;
  if (solver == ResponseSolver::explicit_motion) options.axial = true;  // the whole equations
  ResponseResult result = simulate_response(scene, options);
  EXPECT_TRUE(result.completed) << name_of(solver) << ": " << result.reason;
  return result;
}

double relative_difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, int column) {
  return (a.col(column) - b.col(column)).norm() / b.col(column).norm();
}

/// Relative difference in a column that varies about a large mean, such as a tension.
double changes_apart(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, int column) {
  const Eigen::VectorXd change = b.col(column).array() - b.col(column).mean();
  return (a.col(column) - b.col(column)).norm() / change.norm();
}

TEST(Response, SmallReleaseIsLinearAndAgreesWithTheExactEquations) {
  const Scene scene = testing::released_cable(20, 0.002);
  const ResponseResult linear = respond(scene, ResponseSolver::automatic, 0.5, 1000);
  EXPECT_FALSE(linear.nonlinear);
  EXPECT_EQ(linear.solver, ResponseSolver::modal);
  const ResponseResult exact = respond(scene, ResponseSolver::explicit_motion, 0.5, 1000);
  // Quadratic terms: sag against amplitude (0.3 mm against 5.9 mm and a stretch of its square).
  EXPECT_LT(relative_difference(linear.samples, exact.samples, 0), 2e-3);
}

TEST(Response, SmallHitOutOfThePlaneIsLinear) {
  // The modes that it drives are compared with themselves, not with those in the plane between.
  Scene scene = testing::beam_and_cables(8);
  for (Member& member : scene.members) member.GJ = 0.5;
  scene.loads[0].peak = 0.02;
  const ResponseResult in = respond(scene, ResponseSolver::automatic, 0.1, 1000);
  scene.loads[0].direction = {0, 0, 1};
  scene.sensors[0].direction = {0, 0, 1};
  const ResponseResult out = respond(scene, ResponseSolver::automatic, 0.1, 1000);
  EXPECT_EQ(in.motion, "plane");
  EXPECT_EQ(out.motion, "space");
  for (const ResponseResult& result : {in, out}) {
    EXPECT_LT(result.frequency_shift, 1e-5);
    EXPECT_EQ(result.solver, ResponseSolver::modal);
  }
  // Torsion and a node that turns: the stiff scheme, which takes them, agrees.
  const ResponseResult exact = respond(scene, ResponseSolver::stiff_motion, 0.1, 1000, 1e-8);
  EXPECT_EQ(exact.motion, "space");
  EXPECT_LT(relative_difference(out.samples, exact.samples, 0), 1e-3);
  EXPECT_LT(exact.energy_drift, 1e-4);
}

TEST(Response, DampedReleaseAgreesBetweenSchemesAndItsBalanceCloses) {
  Scene scene = testing::released_cable(10);
  scene.sensors.push_back(testing::sensor("cable", 0.35, Sensor::Quantity::force));
  scene.sensors.push_back(testing::sensor("cable", 0.5, Sensor::Quantity::velocity));
  scene.members[0].damping_ratio = 0.02;
  for (const double rate : {500, 20000}) {  // dampers act once a sample, once in many
    const ResponseResult own = respond(scene, ResponseSolver::explicit_motion, 0.3, rate);
    const ResponseResult stiff = respond(scene, ResponseSolver::stiff_motion, 0.3, rate, 1e-8);
    EXPECT_GT(own.energy.dissipated, 0.01);
    EXPECT_NEAR(own.energy.dissipated / stiff.energy.dissipated, 1, 1e-2);
    // What dampers take is counted in processed velocities, so the balance closes as without them
    // (1e-8) but for the modes' shapes, which turn with the motion.
    EXPECT_LT(own.energy_drift, 1e-5);
    // zeta (omega T)^2 / 12 of the fastest waves; velocities lack up to zeta omega T / 2 of what
    // the dampers have still to take, which samples account for.
    EXPECT_LT(relative_difference(own.samples, stiff.samples, 0), 2e-3);
    EXPECT_LT(changes_apart(own.samples, stiff.samples, 2), 2e-2);
    EXPECT_LT(relative_difference(own.samples, stiff.samples, 3), 2e-4);
  }
}

// Bending shortens a beam's chord, which is no motion of its axial waves: their damping takes
// nothing from a swing of 5 degrees, whatever EA (a rate of 2 zeta omega = 1e4 1/s took a third of
// it in two seconds). Dampers four times as often are the truth.
TEST(Response, AxialDampingLeavesBendingAlone) {
  Scene scene = testing::vertical_beam(0.75, 2.1, 0.295, 20);
  scene.members[0].damping_ratio = 0.01;
  scene.members[0].GJ = 0;
  scene.loads = {testing::impact({"", "beam", 0.8}, {1, 0, 0}, 50, 0.003)};
  scene.sensors = {testing::sensor("beam", 1, Sensor::Quantity::displacement, {1, 0, 0})};
  ResponseOptions options{.solver = ResponseSolver::explicit_motion, .axial = true};
  options.sampling = {.duration_s = 1, .rate_hz = 1000};
  const ResponseResult own = simulate_response(scene, options);
  EXPECT_GT(own.samples.cwiseAbs().maxCoeff(), 0.06);
  options.step_s = own.step_s / 2;
  const ResponseResult often = simulate_response(scene, options);
  EXPECT_LT(relative_difference(own.samples, often.samples, 0), 1e-4);
  scene.members[0].EA /= 100;
  options.step_s = {};
  const ResponseResult soft = simulate_response(scene, options);
  ASSERT_TRUE(own.completed && often.completed && soft.completed);
  EXPECT_LT(relative_difference(own.samples, soft.samples, 0), 2e-3);
}

TEST(Response, JointDampersGoTheStiffWay) {
  // The fastest waves' damping: d omega / (2 EA) = 0.03 and 80, of bending d omega / (2 EI) = 6.7.
  Scene scene = testing::released_cable(10);
  scene.sensors[1].quantity = Sensor::Quantity::force;
  ResponseOptions options;
  options.sampling = {.duration_s = 0.2, .rate_hz = 1000};
  for (const double axial : {1.0, 3000.0}) {
    scene.members[0].damping = {.axial = axial, .bending = 0.05, .torsion = 0};
    const ResponseResult truth = respond(scene, ResponseSolver::stiff_motion, 0.2, 1000, 1e-9);
    options.solver = ResponseSolver::automatic;
    const ResponseResult own = simulate_response(scene, options);
    ASSERT_TRUE(own.completed) << own.reason;
    EXPECT_EQ(own.solver, ResponseSolver::stiff_motion);
    EXPECT_THAT(own.told, HasSubstr("joint dampers"));
    EXPECT_LT(relative_difference(own.samples, truth.samples, 0), 1e-4);
    EXPECT_LT(changes_apart(own.samples, truth.samples, 1), 1e-4);
    EXPECT_LT(own.energy_drift, 1e-4);
    // The explicit scheme refuses them, with the remedy.
    options.solver = ResponseSolver::explicit_motion;
    const ResponseResult refused = simulate_response(scene, options);
    EXPECT_TRUE(refused.impossible);
    EXPECT_THAT(refused.reason, HasSubstr("use stiff"));
  }
}

// A release forced to be linear runs out of phase with the motion: the estimate of that is within a
// factor of three of what it is.
TEST(Response, TellsWhatALinearAnswerToALargeMotionErrsBy) {
  const Scene scene = testing::released_cable(10);
  for (const double duration : {0.2, 0.5, 2.0}) {
    const ResponseResult linear = respond(scene, ResponseSolver::modal, duration, 500);
    const ResponseResult exact = respond(scene, ResponseSolver::explicit_motion, duration, 500);
    const double error = relative_difference(linear.samples, exact.samples, 0);
    EXPECT_GT(linear.linear_error, error / 3) << duration;
    EXPECT_LT(linear.linear_error, 3 * error) << duration;
    EXPECT_EQ(exact.linear_error, 0);
  }
}

TEST(Response, BeamThrownBeyondNinetyDegreesInSpace) {
  // A cantilever, vertical, hit so that its tip swings past the level of its foot: explicit in the
  // plane, explicit in space and the stiff scheme, which works on other unknowns, agree.
  Scene scene = testing::span(
      testing::member(Member::Kind::beam, "beam", "", "", 12, 0.3, 2e4, 0.6),
      testing::node("foot", {0, 0, 0}, Support::Kind::clamped), testing::node("tip", {0, 0.75, 0}));
  scene.loads = {testing::impact({"tip", "", 0}, {1, 0, 0}, 60, 0.02)};
  scene.sensors = {{"tip", {"tip", "", 0}, {0, 1, 0}, Sensor::Quantity::displacement}};
  const ResponseResult plane = respond(scene, ResponseSolver::explicit_motion, 0.4, 1000);
  EXPECT_TRUE(plane.nonlinear);
  // Lower than its foot: every direction between up and down was passed.
  EXPECT_LT(plane.samples.minCoeff(), -0.78);
  EXPECT_LT(plane.energy_drift, 1e-4);
  const ResponseResult space =
      respond(scene, ResponseSolver::explicit_motion, 0.4, 1000, 1e-6, true);
  EXPECT_EQ(space.motion, "space");
  EXPECT_LT(relative_difference(space.samples, plane.samples, 0), 1e-6);
  const ResponseResult stiff = respond(scene, ResponseSolver::stiff_motion, 0.4, 1000, 1e-8, true);
  EXPECT_LT(relative_difference(stiff.samples, plane.samples, 0), 1e-3);
  EXPECT_LT(stiff.energy_drift, 1e-4);
}

TEST(Response, RecordWithoutItsHistoryIsRefused) {
  Scene scene = testing::released_cable(6);
  scene.loads[0].kind = Load::Kind::record;
  EXPECT_ANY_THROW((void)simulate_response(scene, {}));
}

// A chain at rest does not move before a load begins, so the answer to a late impact is that to an
// early one, shifted: of every scheme, where the impact begins at a sample (0.1 s) and between two.
TEST(Response, LateImpactGivesTheShiftedAnswerOfAnEarlyOne) {
  Scene scene = testing::level_cantilever(180, 0.295, 10);
  scene.members[0].damping_ratio = 0.01;
  scene.members[0].GJ = 0;
  for (const bool space : {false, true}) {
    const Eigen::Vector3d way(0, space ? 0.6 : 1, space ? 0.8 : 0);
    scene.sensors = {testing::sensor("beam", 1, Sensor::Quantity::displacement, way)};
    scene.loads = {testing::impact({"", "beam", 0.8}, way, 0.2, 0.003)};
    for (const auto solver :
         {ResponseSolver::modal, ResponseSolver::explicit_motion, ResponseSolver::stiff_motion}) {
      // Modes are exact; the steps are the same ones from 0.1 s on, of (omega h)^4 / 1440 where
      // they begin half a step beside it; the stiff scheme adds its local errors of 1e-6.
      const double tolerance = solver == ResponseSolver::modal ? 1e-9 : 1e-4;
      for (const double offset : {0.0, 0.00025}) {
        scene.loads[0].start = offset;
        const Eigen::MatrixXd first = respond(scene, solver, 0.05, 2000, 1e-6, space).samples;
        scene.loads[0].start = 0.1 + offset;
        const ResponseResult late = respond(scene, solver, 0.15, 2000, 1e-6, space);
        ASSERT_TRUE(late.completed);
        EXPECT_LT(late.samples.topRows(200).norm(), 1e-9 * first.norm());
        EXPECT_LT(relative_difference(late.samples.bottomRows(first.rows()), first, 0), tolerance)
            << name_of(solver) << ' ' << offset << ' ' << space;
        EXPECT_LT(late.energy_drift, 1e-3);
      }
    }
  }
}

}  // namespace rigfit::model::response_test
