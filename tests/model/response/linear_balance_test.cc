#include <gtest/gtest.h>

#include <cmath>

#include "model/response/response.h"
#include "tests/model/motion_scenes.h"

namespace rigfit::model::linear_balance_test {
namespace {

// Supplied, dissipated and stored energy come from three separate computations. Undamped and
// damped, by modal ratios or by joints, driven by a pulse, a record or a hung mass.
TEST(LinearBalance, ClosesWhateverTheLoadAndTheDamping) {
  ForceHistory history;
  for (int i = 0; i <= 40; ++i) {
    history.time_s.push_back(0.01 + 0.002 * i);
    history.force_N.push_back(i == 0 || i == 40 ? 0.0 : std::sin(0.9 * i) + 0.3);
  }
  for (const int damping : {0, 1, 2}) {
    for (const auto kind : {Load::Kind::impact, Load::Kind::record, Load::Kind::release}) {
      Scene scene = testing::beam_and_cables(6);
      for (Member& member : scene.members) {
        if (damping == 1) member.damping_ratio = 0.03;
        if (damping == 2) member.damping = {.axial = 3, .bending = 0.02, .torsion = 0};
      }
      scene.loads[0].kind = kind;
      scene.loads[0].mass = 0.1;
      ResponseOptions options;
      options.sampling = {.duration_s = 0.2, .rate_hz = 1000, .energy_samples = 50};
      options.solver = ResponseSolver::modal;
      options.records = {kind == Load::Kind::record ? history : ForceHistory{}};
      const ResponseResult result = simulate_response(scene, options);
      ASSERT_TRUE(result.completed) << result.reason;
      // Gauss's rule over panels of 2 / omega errs by 2^10 / (2 * 10!^3 / 5!^4 ...) < 1e-8 of the
      // fastest waves, which hold a millionth; joint dampers' poles are known to 1e-9.
      EXPECT_LT(result.energy_drift, 1e-6) << damping << " " << static_cast<int>(kind);
      if (damping > 0) {
        EXPECT_GT(result.energy.dissipated, 0.05 * result.energy.kinetic);
      } else {
        EXPECT_EQ(result.energy.dissipated, 0);
      }
      if (kind == Load::Kind::release) {
        EXPECT_EQ(result.energy.supplied, 0);
      } else {
        EXPECT_GT(result.energy.supplied, 0);
      }
    }
  }
}

}  // namespace
}  // namespace rigfit::model::linear_balance_test
