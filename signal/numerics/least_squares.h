// Linear least squares by orthogonal factorisation with column pivoting.
#pragma once

#include <Eigen/Core>

namespace rigfit::signal {

/// The least |A x - y|^2. A: rows x columns, which may depend on each other.
[[nodiscard]] double least_sum_squares(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                       const Eigen::Ref<const Eigen::VectorXd>& y);

}  // namespace rigfit::signal
