#include "signal/poles/polynomial_zeros.h"

#include <Eigen/Eigenvalues>

namespace rigfit::signal {

using Eigen::Index;
using Eigen::MatrixXd;

Eigen::VectorXcd reciprocal_zeros(const Eigen::Ref<const MatrixXd>& A, Index block_size) {
  const Index size = A.rows();
  MatrixXd companion = MatrixXd::Zero(size, size);
  for (Index block = 0; block < size / block_size; ++block) {
    companion.block(0, block * block_size, block_size, block_size) =
        -A.block(block * block_size, 0, block_size, block_size);
  }
  companion.bottomLeftCorner(size - block_size, size - block_size).setIdentity();
  const Eigen::EigenSolver<MatrixXd> solver(companion, false);
  if (solver.info() != Eigen::Success) return {};
  return solver.eigenvalues();
}

}  // namespace rigfit::signal
