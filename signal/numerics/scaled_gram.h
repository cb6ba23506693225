// Normal equations of least squares: the Cholesky factor of a Gram matrix whose columns are scaled
// to length 1, with a test whether the columns can be told apart.
#pragma once

#include <Eigen/Core>

namespace rigfit::signal {

class ScaledGram {
 public:
  /// `gram`: symmetric, the lower half is read.
  explicit ScaledGram(const Eigen::Ref<const Eigen::MatrixXd>& gram);

  /// False when a column depends on those before it but for an angle of 1e-7: rounding in the Gram
  /// matrix hides smaller ones.
  [[nodiscard]] bool usable() const { return usable_; }
  /// gram^-1 right.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& right) const;
  [[nodiscard]] Eigen::VectorXd solve_vector(const Eigen::Ref<const Eigen::VectorXd>& right) const;
  [[nodiscard]] Eigen::MatrixXd inverse() const;
  /// The columns whose Gram matrix this is, made orthonormal.
  [[nodiscard]] Eigen::MatrixXd orthonormal(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;

 private:
  Eigen::VectorXd scale_;
  Eigen::MatrixXd factor_;  ///< lower triangle
  bool usable_ = false;
};

/// columns' columns, both halves, at half the work of a product.
[[nodiscard]] Eigen::MatrixXd gram_of(const Eigen::Ref<const Eigen::MatrixXd>& columns);

}  // namespace rigfit::signal
