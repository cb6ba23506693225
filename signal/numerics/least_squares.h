// Linear least squares by orthogonal factorisation with column pivoting.
#pragma once

#include <Eigen/Core>

namespace rigfit::signal {

struct LeastSquares {
  Eigen::MatrixXd x;  ///< columns x right-hand sides; 0 where a column depends on others
  Eigen::VectorXd left_sum_squares;  ///< residual sum of squares, by right-hand side
  /// Ratio of the largest to the smallest pivot; columns that cannot be told apart make it large,
  /// up to infinity.
  double condition = 0;
};

/// Minimises |A x - y| for each column of `y`. A: rows x columns.
[[nodiscard]] LeastSquares least_squares(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                         const Eigen::Ref<const Eigen::MatrixXd>& y);

}  // namespace rigfit::signal
