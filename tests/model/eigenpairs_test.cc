#include "model/eigenpairs.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/modes.h"
#include "tests/bench/pole_line.h"

namespace rigfit::model::eigenpairs_test {
namespace {

// Fifty like spans: their first frequencies crowd within 3 %, more of them than are asked for, and
// the spectrum is taken in slices.
TEST(Eigenpairs, CrowdedOnesOfALongLineAreAllFound) {
  ModesOptions options;
  options.count = 50;
  const ChainModes modes = find_modes(testing::pole_line(50, 30, 10), options);
  ASSERT_EQ(modes.order.size(), 50u);
  EXPECT_TRUE(modes.complete());
  for (const MotionModes& motion : modes.motions) {
    ASSERT_GT(motion.stiffness.size(), 1500);
    const Eigen::Index count = motion.omega2.size();
    Eigen::MatrixXd mass_times(motion.shapes.rows(), count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::VectorXd x = motion.shapes.col(i);
      mass_times.col(i) = motion.mass * x;
      const Eigen::VectorXd r = motion.stiffness * x - motion.omega2[i] * mass_times.col(i);
      // Found to 1e-10 of the shifted problem; rounding of K, 1e-16 EA / l over omega^2 m, 1e-6.
      EXPECT_LT(r.norm(), 1e-5 * motion.omega2[i] * mass_times.col(i).norm()) << i;
      if (i > 0) {
        EXPECT_GE(motion.omega2[i], motion.omega2[i - 1]);
      }
      // A proof by another factor that none was missed and none is there twice.
      EXPECT_LE(count_below(motion.stiffness, motion.mass, motion.omega2[i] * (1 - 1e-8)), i);
      EXPECT_GE(count_below(motion.stiffness, motion.mass, motion.omega2[i] * (1 + 1e-8)), i + 1);
    }
    const Eigen::MatrixXd overlap =
        motion.shapes.transpose() * mass_times - Eigen::MatrixXd::Identity(count, count);
    EXPECT_LT(overlap.cwiseAbs().maxCoeff(), 1e-6);
  }
}

}  // namespace
}  // namespace rigfit::model::eigenpairs_test
