#include "signal/numerics/scaled_gram.h"

#include <Eigen/Cholesky>

namespace rigfit::signal {

using Eigen::MatrixXd;
using Eigen::VectorXd;

ScaledGram::ScaledGram(const Eigen::Ref<const MatrixXd>& gram)
    : scale_(gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse()),
      factor_(scale_.asDiagonal() * gram * scale_.asDiagonal()) {
  if (gram.size() == 0) {
    usable_ = true;
    return;
  }
  const Eigen::LLT<Eigen::Ref<MatrixXd>> factorised(factor_);  // in place
  // A pivot is the sine of a column's angle to those before it.
  const auto pivots = factor_.diagonal();
  usable_ = factorised.info() == Eigen::Success && pivots.allFinite() && pivots.minCoeff() > 1e-7;
}

MatrixXd ScaledGram::solve(const Eigen::Ref<const MatrixXd>& right) const {
  MatrixXd x = scale_.asDiagonal() * right;
  if (x.size() == 0) return x;
  factor_.triangularView<Eigen::Lower>().solveInPlace(x);
  factor_.transpose().triangularView<Eigen::Upper>().solveInPlace(x);
  return scale_.asDiagonal() * x;
}

VectorXd ScaledGram::solve_vector(const Eigen::Ref<const VectorXd>& right) const {
  return solve(right);
}

MatrixXd ScaledGram::inverse() const {
  return solve(MatrixXd::Identity(factor_.rows(), factor_.rows()));
}

MatrixXd ScaledGram::orthonormal(const Eigen::Ref<const MatrixXd>& columns) const {
  // columns * scale * L^-T, as (L^-1 (columns * scale)')'.
  MatrixXd result = (columns * scale_.asDiagonal()).transpose();
  if (result.size() > 0) factor_.triangularView<Eigen::Lower>().solveInPlace(result);
  return result.transpose();
}

MatrixXd gram_of(const Eigen::Ref<const MatrixXd>& columns) {
  MatrixXd gram = MatrixXd::Zero(columns.cols(), columns.cols());
  if (columns.size() == 0) return gram;
  gram.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  return gram;
}

}  // namespace rigfit::signal
