// Eigen's factorisations of dense matrices that several rooms need, compiled once: each source that
// instantiates one of them takes seconds more to compile.
#pragma once

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

/// A = Q R for A of m x n, m >= n.
template <class Matrix>
struct ThinQr {
  Matrix Q;  ///< m x n, orthonormal columns
  Matrix R;  ///< n x n, upper triangular; |diagonal| is each column's length outside those before
};

[[nodiscard]] ThinQr<MatrixXd> thin_qr(const Ref<const MatrixXd>& A);
[[nodiscard]] ThinQr<MatrixXcd> thin_qr(const Ref<const MatrixXcd>& A);

/// A = V diag(values) V' for A = A' of n x n.
struct HermitianEigen {
  VectorXd values;    ///< rising
  MatrixXcd vectors;  ///< n x n, orthonormal columns

  /// V diag(1 / values) V', with 0 for values within rounding of 0.
  [[nodiscard]] MatrixXcd pseudo_inverse() const;
};

[[nodiscard]] HermitianEigen hermitian_eigen(const Ref<const MatrixXcd>& A);

/// The least |A x - y|^2. A: rows x columns, which may depend on each other.
[[nodiscard]] double least_sum_squares(const Ref<const MatrixXd>& A, const Ref<const VectorXd>& y);

/// Normal equations of least squares: the Cholesky factor of a Gram matrix whose columns are scaled
/// to length 1, with a test whether the columns can be told apart.
class ScaledGram {
 public:
  /// `gram`: symmetric, the lower half is read.
  explicit ScaledGram(const Ref<const MatrixXd>& gram);

  /// False when a column depends on those before it but for an angle of 1e-7: rounding in the Gram
  /// matrix hides smaller ones.
  [[nodiscard]] bool usable() const { return usable_; }
  /// gram^-1 right.
  [[nodiscard]] MatrixXd solve(const Ref<const MatrixXd>& right) const;
  [[nodiscard]] VectorXd solve_vector(const Ref<const VectorXd>& right) const;
  [[nodiscard]] MatrixXd inverse() const;
  /// The columns whose Gram matrix this is, made orthonormal.
  [[nodiscard]] MatrixXd orthonormal(const Ref<const MatrixXd>& columns) const;

 private:
  VectorXd scale_;
  MatrixXd factor_;  ///< lower triangle
  bool usable_ = false;
};

/// columns' columns, both halves, at half the work of a product.
[[nodiscard]] MatrixXd gram_of(const Ref<const MatrixXd>& columns);

}  // namespace rigfit::signal
