// Eigenvalues of full symmetric matrices, rising, for checks by dense algebra.
#pragma once

#include <Eigen/Eigenvalues>

namespace rigfit::model::testing {

/// Of A x = lambda x.
[[nodiscard]] inline Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

/// Of A x = lambda B x, B positive definite.
[[nodiscard]] inline Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& A,
                                                           const Eigen::MatrixXd& B) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(A, B, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

}  // namespace rigfit::model::testing
