#include "signal/numerics/least_squares.h"

#include "signal/numerics/scaled_gram.h"
#include "tests/test.h"

namespace rigfit::signal::least_squares_test {

using Eigen::MatrixXd;

/// Columns 1, t, t^2 ... on 0 .. 1: condition grows by about 6 a column.
MatrixXd powers(Index rows, Index columns) {
  MatrixXd A(rows, columns);
  for (Index k = 0; k < rows; ++k) {
    double power = 1;
    for (Index c = 0; c < columns; ++c) {
      A(k, c) = power;
      power *= static_cast<double>(k) / static_cast<double>(rows - 1);
    }
  }
  return A;
}

TEST(LeastSquares, RecoversWhatTheColumnsMade) {
  const MatrixXd A = powers(50, 8);
  const MatrixXd x = MatrixXd::Random(8, 3);
  const LeastSquares found = least_squares(A, A * x);
  // Condition about 1e6: ten digits are left.
  EXPECT_TRUE(MatricesNear(found.x, x, 1e-9));
  EXPECT_LT(found.left_sum_squares.maxCoeff(), 1e-26);
  EXPECT_GT(found.condition, 1e3);
  EXPECT_LT(found.condition, 1e8);
}

TEST(LeastSquares, LeavesWhatIsOrthogonalToTheColumns) {
  const MatrixXd A = powers(200, 5), y = MatrixXd::Random(200, 4);
  const LeastSquares found = least_squares(A, y);
  const MatrixXd left = y - A * found.x;
  EXPECT_LT((A.transpose() * left).cwiseAbs().maxCoeff(), 1e-11);
  for (Index c = 0; c < 4; ++c) {
    EXPECT_NEAR(found.left_sum_squares[c], left.col(c).squaredNorm(), 1e-12);
  }
}

TEST(LeastSquares, AColumnThatDependsOnOthersGetsNothing) {
  MatrixXd A = powers(30, 4);
  A.col(3) = 2 * A.col(1) - A.col(0);
  const MatrixXd y = MatrixXd::Random(30, 1);
  const LeastSquares found = least_squares(A, y);
  EXPECT_TRUE(found.x.allFinite());
  EXPECT_EQ((found.x.array() == 0).count(), 1);
  EXPECT_TRUE(std::isinf(found.condition));
  EXPECT_NEAR(found.left_sum_squares[0], least_squares(A.leftCols(3), y).left_sum_squares[0],
              1e-12);
}

TEST(ScaledGram, SolvesAndTellsWhenColumnsDepend) {
  MatrixXd A = powers(40, 4);
  A.col(2) *= 1e9;  // scale is no dependence
  const MatrixXd gram = gram_of(A);
  EXPECT_TRUE(MatricesNear(gram, MatrixXd(A.transpose() * A), 1e-12 * gram.maxCoeff()));
  const ScaledGram factor(gram);
  ASSERT_TRUE(factor.usable());
  const MatrixXd y = MatrixXd::Random(40, 2);
  const MatrixXd expected = least_squares(A, y).x, found = factor.solve(A.transpose() * y);
  // Condition of the scaled Gram matrix: that of A squared, under 1e5.
  EXPECT_LT(((found - expected).array() / expected.array()).abs().maxCoeff(), 1e-9);
  EXPECT_TRUE(MatricesNear(MatrixXd(factor.inverse() * gram), MatrixXd::Identity(4, 4),
                           1e-2));  // the scale of 1e9 against its inverse
  const MatrixXd Q = factor.orthonormal(A);
  EXPECT_TRUE(MatricesNear(MatrixXd(Q.transpose() * Q), MatrixXd::Identity(4, 4), 1e-9));
  A.col(3) = A.col(0) + 1e-10 * A.col(1);
  EXPECT_FALSE(ScaledGram(gram_of(A)).usable());
  EXPECT_TRUE(ScaledGram(MatrixXd(0, 0)).usable());
}

}  // namespace rigfit::signal::least_squares_test
