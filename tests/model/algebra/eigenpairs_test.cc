#include "model/algebra/eigenpairs.h"

#include "model/linear/modes.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::eigenpairs_test {

// Fifty like spans: their first frequencies crowd within 3 %, more of them than are asked for, and
// the spectrum is taken in slices.
TEST(Eigenpairs, CrowdedOnesOfALongLineAreAllFound) {
  const ChainModes modes = find_modes(testing::utility_line(50, 30, 10), {.count = 50});
  ASSERT_EQ(modes.order.size(), 50u);
  EXPECT_TRUE(modes.complete());
  for (const MotionModes& motion : modes.motions) {
    ASSERT_GT(motion.stiffness.size(), 1500);
    const Index count = motion.omega2.size();
    Eigen::MatrixXd mass_times(motion.shapes.rows(), count);
    for (Index i = 0; i < count; ++i) {
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

// The crowd's edge: equal oscillators in a row, coupled by 1e-6 of their stiffness, have
// lambda_j = 1 + 4e-6 sin^2(j pi / (2 (N + 1))), the lowest of them 1e-12 apart. A shift that does
// not lie among those wanted would have to tell far more of the 2000 apart than are asked for.
TEST(Eigenpairs, EdgeOfACrowdTakesNoMoreVectorsThanElsewhere) {
  constexpr int kSize = 2000, kCount = 24;
  constexpr double kCoupling = 1e-6;
  std::vector<int> first(kSize);
  for (int i = 0; i < kSize; ++i) first[i] = std::max(0, i - 1);
  const auto envelope = Envelope::from_rows(first);
  EnvelopeMatrix k(envelope), m(envelope);
  for (int i = 0; i < kSize; ++i) {
    k.add(i, i, 1 + 2 * kCoupling);
    if (i > 0) k.add(i, i - 1, -kCoupling);
    m.add(i, i, 1);
  }
  const Eigenpairs pairs = lowest_eigenpairs(k, m, kCount);
  ASSERT_EQ(pairs.values.size(), kCount);
  EXPECT_TRUE(pairs.complete);
  for (int j = 1; j <= kCount; ++j) {
    const double s = std::sin(j * kPi / (2 * (kSize + 1)));
    // Rounding of K's diagonal is 1e-16; the shifted problem adds as much a few times over.
    EXPECT_NEAR(pairs.values[j - 1], 1 + 4 * kCoupling * s * s, 1e-14) << j;
  }
  // Evenly spread eigenvalues take two to three vectors each.
  EXPECT_LT(pairs.steps, 6 * kCount);
}

}  // namespace rigfit::model::eigenpairs_test
