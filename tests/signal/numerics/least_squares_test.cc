#include "signal/numerics/factorisations.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "tests/test.h"

namespace rigfit::signal::least_squares_test {

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

TEST(LeastSquares, LeavesWhatIsOrthogonalToTheColumns) {
  MatrixXd A = powers(200, 5);
  const VectorXd y = VectorXd::Random(200), x = VectorXd::Random(5);
  const MatrixXd gram = A.transpose() * A;
  const double expected =
      y.squaredNorm() - (A.transpose() * y).dot(gram.ldlt().solve(A.transpose() * y));
  EXPECT_NEAR(least_sum_squares(A, y), expected, 1e-8);
  EXPECT_NEAR(least_sum_squares(A, y + A * x), expected, 1e-8);
  EXPECT_LT(least_sum_squares(A, A * x), 1e-26);
  A.col(4) = 2 * A.col(1) - A.col(0);  // depends on others
  EXPECT_NEAR(least_sum_squares(A, y), least_sum_squares(A.leftCols(4), y), 1e-12);
}

TEST(ScaledGram, SolvesAndTellsWhenColumnsDepend) {
  MatrixXd A = powers(40, 4);
  A.col(2) *= 1e9;  // scale is no dependence
  const MatrixXd gram = gram_of(A);
  EXPECT_TRUE(MatricesNear(gram, MatrixXd(A.transpose() * A), 1e-12 * gram.maxCoeff()));
  const ScaledGram factor(gram);
  ASSERT_TRUE(factor.usable());
  const MatrixXd y = MatrixXd::Random(40, 2);
  const MatrixXd expected = A.colPivHouseholderQr().solve(y),
                 found = factor.solve(A.transpose() * y);
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

template <class Matrix>
void expect_thin_qr(const Matrix& A) {
  const ThinQr<Matrix> qr = thin_qr(A);
  const Index n = A.cols();
  EXPECT_LT((qr.Q * qr.R - A).norm(), 1e-14 * A.norm());
  EXPECT_LT((qr.Q.adjoint() * qr.Q - Matrix::Identity(n, n)).norm(), 1e-14);
  EXPECT_EQ(qr.R.template triangularView<Eigen::StrictlyLower>().toDenseMatrix().norm(), 0);
}

TEST(Factorisations, ThinQr) {
  expect_thin_qr<MatrixXd>(MatrixXd::Random(40, 5));
  expect_thin_qr<MatrixXcd>(MatrixXcd::Random(40, 5));
}

TEST(Factorisations, PseudoInverseOfADeficientHermitianMatrixHasPenrosesProperties) {
  const MatrixXcd half = MatrixXcd::Random(6, 4), A = half * half.adjoint();
  const HermitianEigen eigen = hermitian_eigen(A);
  EXPECT_LT((eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.adjoint() - A).norm(),
            1e-13);
  const MatrixXcd X = eigen.pseudo_inverse();
  EXPECT_LT((A * X * A - A).norm(), 1e-10 * A.norm());
  EXPECT_LT((X * A * X - X).norm(), 1e-10 * X.norm());
  EXPECT_LT((A * X - (A * X).adjoint()).norm(), 1e-10);
  EXPECT_NEAR((A * X).trace().real(), 4, 1e-9);
}

}  // namespace rigfit::signal::least_squares_test
