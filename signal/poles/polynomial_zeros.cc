#include "signal/poles/polynomial_zeros.h"

#include <Eigen/Eigenvalues>

namespace rigfit::signal {

using Eigen::Index;
using Eigen::MatrixXd;

Eigen::VectorXcd reciprocal_zeros(const Eigen::Ref<const MatrixXd>& A, Index block_size,
                                  Eigen::MatrixXcd* left) {
  const Index size = A.rows();
  MatrixXd companion = MatrixXd::Zero(size, size);
  for (Index block = 0; block < size / block_size; ++block) {
    // The transposed blocks have the same zeros, and the left vectors for eigenvectors.
    const auto part = A.block(block * block_size, 0, block_size, block_size);
    auto target = companion.block(0, block * block_size, block_size, block_size);
    if (left) {
      target = -part.transpose();
    } else {
      target = -part;
    }
  }
  companion.bottomLeftCorner(size - block_size, size - block_size).setIdentity();
  const Eigen::EigenSolver<MatrixXd> solver(companion, left != nullptr);
  if (solver.info() != Eigen::Success) return {};
  if (left) *left = solver.eigenvectors().bottomRows(block_size).colwise().normalized();
  return solver.eigenvalues();
}

}  // namespace rigfit::signal
