// Eigen's factorisations of dense matrices that several rooms need, compiled once: each source that
// instantiates one of them takes seconds more to compile.
#pragma once

#include <Eigen/Core>

namespace rigfit::signal {

/// A = Q R for A of m x n, m >= n.
template <class Matrix>
struct ThinQr {
  Matrix Q;  ///< m x n, orthonormal columns
  Matrix R;  ///< n x n, upper triangular; |diagonal| is each column's length outside those before
};

[[nodiscard]] ThinQr<Eigen::MatrixXd> thin_qr(const Eigen::Ref<const Eigen::MatrixXd>& A);
[[nodiscard]] ThinQr<Eigen::MatrixXcd> thin_qr(const Eigen::Ref<const Eigen::MatrixXcd>& A);

/// A = V diag(values) V' for A = A' of n x n.
struct HermitianEigen {
  Eigen::VectorXd values;    ///< rising
  Eigen::MatrixXcd vectors;  ///< n x n, orthonormal columns

  /// V diag(1 / values) V', with 0 for values within rounding of 0.
  [[nodiscard]] Eigen::MatrixXcd pseudo_inverse() const;
};

[[nodiscard]] HermitianEigen hermitian_eigen(const Eigen::Ref<const Eigen::MatrixXcd>& A);

/// The least |A x - y|^2. A: rows x columns, which may depend on each other.
[[nodiscard]] double least_sum_squares(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                       const Eigen::Ref<const Eigen::VectorXd>& y);

}  // namespace rigfit::signal
