#include "model/motion/implicit_motion.h"

#include <gtest/gtest.h>

#include "model/response/response.h"
#include "tests/model/motion_scenes.h"

namespace rigfit::model::implicit_motion_test {
namespace {

// A rig struck across its plane, torsion and turning nodes in space, with steps so long that
// Newton's method diverges in some and halves them: the account closes as well as where it does
// not. Gauss's rule errs by h^6, Newton by 1e-9 of the largest force in each of 400 steps.
TEST(ImplicitMotion, EnergyAccountClosesInSpaceWhereStepsAreHalved) {
  Scene scene = testing::beam_and_cables(10);
  scene.members[0].GJ = 1.5;
  scene.loads[0].direction = {0.6, 0, 0.8};
  scene.loads[0].peak = 100;
  ResponseOptions options;
  options.solver = ResponseSolver::implicit_motion;
  options.plane = false;
  options.step_s = 0.0005;
  options.sampling = {.duration_s = 0.2, .rate_hz = 2000, .energy_samples = 100};
  const ResponseResult out = simulate_response(scene, options);
  ASSERT_TRUE(out.completed) << out.reason;
  EXPECT_GT(out.steps, 400);  // some were halved
  EXPECT_LT(out.energy_drift, 1e-5);
}

}  // namespace
}  // namespace rigfit::model::implicit_motion_test
