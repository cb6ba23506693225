#include "model/algebra/envelope_matrix.h"

#include "model/algebra/bordered_solver.h"
#include "model/linear/modes.h"
#include "tests/reference/dense_eigen.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::envelope_matrix_test {

template <class Scalar>
EnvelopeMatrixOf<Scalar> random_matrix(int n, std::mt19937_64& random) {
  std::vector<int> first;
  for (int i = 0; i < n; ++i) {
    first.push_back(std::max(0, i - std::uniform_int_distribution<int>(0, 9)(random)));
  }
  EnvelopeMatrixOf<Scalar> matrix(Envelope::from_rows(first));
  std::normal_distribution<double> normal;
  for (int i = 0; i < n; ++i) {
    for (int j = first[i]; j <= i; ++j) {
      if constexpr (std::is_same_v<Scalar, double>) {
        matrix.add(i, j, normal(random));
      } else {
        matrix.add(i, j, Scalar(normal(random), normal(random)));
      }
    }
    matrix.add(i, i, 2 * normal(random));
  }
  return matrix;
}

TEST(EnvelopeFactor, SolvesAndCountsAsDenseAlgebraDoes) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const auto matrix = random_matrix<double>(40, random);
    const Eigen::MatrixXd dense = matrix.sparse();
    const Eigen::VectorXd x = Eigen::VectorXd::Random(40);
    Eigen::VectorXd y = matrix * x;
    EXPECT_TRUE(MatricesNear(y, dense * x, 1e-12));
    EnvelopeFactor factor;
    ASSERT_TRUE(factor.factor(matrix));
    factor.solve_in_place(y);
    // No pivoting: the error grows with the inverse of the smallest pivot met.
    EXPECT_TRUE(MatricesNear(y, x, 1e-10 / factor.smallest_pivot_ratio()));
    EXPECT_EQ(factor.negative_pivots(),
              (testing::symmetric_eigenvalues(dense).array() < 0).count());
  }
}

TEST(EnvelopeFactor, NamesTheRowOfASingularPivot) {
  EnvelopeMatrix matrix(Envelope::from_rows({0, 0, 1}));
  matrix.add(0, 0, 1);
  matrix.add(1, 0, 1);
  matrix.add(1, 1, 1);
  matrix.add(2, 2, 3);
  EnvelopeFactor factor;
  EXPECT_FALSE(factor.factor(matrix));
  EXPECT_EQ(factor.smallest_pivot_row(), 1);
}

// Twelve tensioned spans in a row, and six.
TEST(BorderedSolver, LongLineHasItsTensions) {
  for (const int poles : {5, 11}) {
    Scene line = testing::utility_line(poles, 20, 6);
    std::vector<double> tension;
    for (Member& member : line.members) {  // unlike spans bend the poles between them
      if (member.tension)
        tension.push_back(*(member.tension = 3000 + 150.0 * (tension.size() % 3)));
    }
    const ChainModes prepared = prepare_motions(line, {});
    ASSERT_EQ(prepared.equilibrium.status, EquilibriumStatus::converged) << poles;
    EXPECT_LT(prepared.equilibrium.residual, 1e-9);
    std::size_t span = 0;
    for (const auto& member : describe(*prepared.chain, prepared.equilibrium, line).members) {
      if (member.member.rfind("conductor", 0) != 0) continue;
      ASSERT_LT(span, tension.size());
      // The residual, 1e-9 of the largest force, is also that of the tensions.
      EXPECT_NEAR(member.tension_N, tension[span++], 3000 * 1e-8) << member.member;
    }
    EXPECT_EQ(span, std::size_t(poles + 1));
  }
}

}  // namespace rigfit::model::envelope_matrix_test
