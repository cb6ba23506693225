#include "signal/numerics/factorisations.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <limits>

namespace rigfit::signal {
namespace {

template <class Matrix>
ThinQr<Matrix> factorised(const Eigen::Ref<const Matrix>& A) {
  const Eigen::Index columns = A.cols();
  const Eigen::HouseholderQR<Matrix> qr(A);
  return {qr.householderQ() * Matrix::Identity(A.rows(), columns),
          qr.matrixQR().topRows(columns).template triangularView<Eigen::Upper>()};
}

}  // namespace

ThinQr<Eigen::MatrixXd> thin_qr(const Eigen::Ref<const Eigen::MatrixXd>& A) {
  return factorised<Eigen::MatrixXd>(A);
}

ThinQr<Eigen::MatrixXcd> thin_qr(const Eigen::Ref<const Eigen::MatrixXcd>& A) {
  return factorised<Eigen::MatrixXcd>(A);
}

double least_sum_squares(const Eigen::Ref<const Eigen::MatrixXd>& A,
                         const Eigen::Ref<const Eigen::VectorXd>& y) {
  return (y - A * A.colPivHouseholderQr().solve(y)).squaredNorm();
}

HermitianEigen hermitian_eigen(const Eigen::Ref<const Eigen::MatrixXcd>& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::MatrixXcd HermitianEigen::pseudo_inverse() const {
  const double rounding = std::numeric_limits<double>::epsilon() *
                          static_cast<double>(values.size()) * values.cwiseAbs().maxCoeff();
  const Eigen::ArrayXd inverse =
      (values.array().abs() > rounding).select(values.array().inverse(), 0);
  return vectors * inverse.matrix().asDiagonal() * vectors.adjoint();
}

}  // namespace rigfit::signal
