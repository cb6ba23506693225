#include "signal/poles/polynomial_zeros.h"

#include <Eigen/Eigenvalues>
#include <utility>

#include "signal/poles/hessenberg_eigenvalues.h"

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
  const double scale = companion.cwiseAbs().maxCoeff();
  companion /= scale;
  if (block_size > 1) companion = Eigen::HessenbergDecomposition<MatrixXd>(companion).matrixH();
  return hessenberg_eigenvalues(std::move(companion), scale);
}

}  // namespace rigfit::signal
