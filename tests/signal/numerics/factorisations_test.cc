#include "signal/numerics/factorisations.h"

#include "tests/test.h"

namespace rigfit::signal {
namespace {

using Eigen::MatrixXcd;

template <class Matrix>
void expect_thin_qr(const Matrix& A) {
  const ThinQr<Matrix> qr = thin_qr(A);
  const Index n = A.cols();
  EXPECT_LT((qr.Q * qr.R - A).norm(), 1e-14 * A.norm());
  EXPECT_LT((qr.Q.adjoint() * qr.Q - Matrix::Identity(n, n)).norm(), 1e-14);
  EXPECT_EQ(qr.R.template triangularView<Eigen::StrictlyLower>().toDenseMatrix().norm(), 0);
}

TEST(Factorisations, ThinQr) {
  expect_thin_qr<Eigen::MatrixXd>(Eigen::MatrixXd::Random(40, 5));
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

}  // namespace
}  // namespace rigfit::signal
