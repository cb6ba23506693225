// Eigenvalues of full symmetric matrices, for checks by dense algebra: the solvers' heavy templates
// in one place.
#pragma once

#include <Eigen/Core>

namespace rigfit::model::testing {

/// Of A x = lambda x, rising.
[[nodiscard]] Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& A);
/// Of A x = lambda B x, B positive definite, rising.
[[nodiscard]] Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& A,
                                                    const Eigen::MatrixXd& B);

}  // namespace rigfit::model::testing
