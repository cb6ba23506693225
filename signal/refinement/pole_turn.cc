#include "signal/refinement/pole_turn.h"

#include <cmath>

namespace rigfit::signal {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd turned(const MatrixXd& A, const Eigen::Ref<const VectorXd>& residues) {
  const Index size = A.rows();
  MatrixXd half(size, size), result(size, size);
  for (Index r = 0; r < size; r += 2) {
    const double a = residues[r], b = residues[r + 1];
    half.col(r) = a * A.col(r) + b * A.col(r + 1);
    half.col(r + 1) = -b * A.col(r) + a * A.col(r + 1);
  }
  for (Index r = 0; r < size; r += 2) {
    const double a = residues[r], b = residues[r + 1];
    result.row(r) = a * half.row(r) + b * half.row(r + 1);
    result.row(r + 1) = -b * half.row(r) + a * half.row(r + 1);
  }
  return result;
}

VectorXd turned_vector(const Eigen::Ref<const VectorXd>& v,
                       const Eigen::Ref<const VectorXd>& residues) {
  VectorXd result(v.size());
  for (Index r = 0; r < v.size(); r += 2) {
    const double a = residues[r], b = residues[r + 1];
    result[r] = a * v[r] + b * v[r + 1];
    result[r + 1] = -b * v[r] + a * v[r + 1];
  }
  return result;
}

MatrixXd turned_columns(const MatrixXd& X, const Eigen::Ref<const VectorXd>& residues) {
  MatrixXd result(X.rows(), X.cols());
  for (Index r = 0; r < X.cols(); r += 2) {
    const double a = residues[r], b = residues[r + 1];
    result.col(r) = a * X.col(r) + b * X.col(r + 1);
    result.col(r + 1) = -b * X.col(r) + a * X.col(r + 1);
  }
  return result;
}

MatrixXd summed_turns(const MatrixXd& A, const MatrixXd& coefficients, const VectorXd& weight) {
  MatrixXd sum = MatrixXd::Zero(A.rows(), A.rows());
  for (Index c = 0; c < coefficients.cols(); ++c) {
    if (weight[c] == 0) continue;
    sum += weight[c] * turned(A, coefficients.col(c).head(A.rows()));
  }
  return sum;
}

VectorXd inverse_variance_of(const FrfNoise& noise) {
  return noise.column.unaryExpr([](double v) { return std::isfinite(v) && v > 0 ? 1 / v : 0.0; });
}

}  // namespace rigfit::signal
