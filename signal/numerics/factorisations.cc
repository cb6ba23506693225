#include "signal/numerics/factorisations.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace rigfit::signal {
namespace {

template <class Matrix>
ThinQr<Matrix> factorised(const Ref<const Matrix>& A) {
  const Index columns = A.cols();
  const Eigen::HouseholderQR<Matrix> qr(A);
  return {qr.householderQ() * Matrix::Identity(A.rows(), columns),
          qr.matrixQR().topRows(columns).template triangularView<Eigen::Upper>()};
}

}  // namespace

ThinQr<MatrixXd> thin_qr(const Ref<const MatrixXd>& A) { return factorised<MatrixXd>(A); }

ThinQr<MatrixXcd> thin_qr(const Ref<const MatrixXcd>& A) { return factorised<MatrixXcd>(A); }

double least_sum_squares(const Ref<const MatrixXd>& A, const Ref<const VectorXd>& y) {
  return (y - A * A.colPivHouseholderQr().solve(y)).squaredNorm();
}

HermitianEigen hermitian_eigen(const Ref<const MatrixXcd>& A) {
  const Eigen::SelfAdjointEigenSolver<MatrixXcd> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

MatrixXcd HermitianEigen::pseudo_inverse() const {
  const double rounding = std::numeric_limits<double>::epsilon() *
                          static_cast<double>(values.size()) * values.cwiseAbs().maxCoeff();
  const ArrayXd inverse = (values.array().abs() > rounding).select(values.array().inverse(), 0);
  return vectors * inverse.matrix().asDiagonal() * vectors.adjoint();
}

ScaledGram::ScaledGram(const Ref<const MatrixXd>& gram)
    : scale_(gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse()),
      factor_(scale_.asDiagonal() * gram * scale_.asDiagonal()) {
  if (gram.size() == 0) {
    usable_ = true;
    return;
  }
  const Eigen::LLT<Ref<MatrixXd>> factorised(factor_);  // in place
  // A pivot is the sine of a column's angle to those before it.
  const auto pivots = factor_.diagonal();
  usable_ = factorised.info() == Eigen::Success && pivots.allFinite() && pivots.minCoeff() > 1e-7;
}

MatrixXd ScaledGram::solve(const Ref<const MatrixXd>& right) const {
  MatrixXd x = scale_.asDiagonal() * right;
  if (x.size() == 0) return x;
  factor_.triangularView<Eigen::Lower>().solveInPlace(x);
  factor_.transpose().triangularView<Eigen::Upper>().solveInPlace(x);
  return scale_.asDiagonal() * x;
}

VectorXd ScaledGram::solve_vector(const Ref<const VectorXd>& right) const { return solve(right); }

MatrixXd ScaledGram::inverse() const {
  return solve(MatrixXd::Identity(factor_.rows(), factor_.rows()));
}

MatrixXd ScaledGram::orthonormal(const Ref<const MatrixXd>& columns) const {
  // columns * scale * L^-T, as (L^-1 (columns * scale)')'.
  MatrixXd result = (columns * scale_.asDiagonal()).transpose();
  if (result.size() > 0) factor_.triangularView<Eigen::Lower>().solveInPlace(result);
  return result.transpose();
}

MatrixXd gram_of(const Ref<const MatrixXd>& columns) {
  MatrixXd gram = MatrixXd::Zero(columns.cols(), columns.cols());
  if (columns.size() == 0) return gram;
  gram.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  return gram;
}

}  // namespace rigfit::signal
