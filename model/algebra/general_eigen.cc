#include "model/algebra/general_eigen.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace rigfit::model {

GeneralEigenpairs general_eigenpairs(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  GeneralEigenpairs out;
  const Eigen::EigenSolver<Eigen::MatrixXd> eigen(matrix);
  out.values = eigen.eigenvalues();
  out.vectors = eigen.eigenvectors();
  if (right.cols() > 0) {
    out.coordinates = out.vectors.partialPivLu().solve(right.cast<std::complex<double>>());
  }
  return out;
}

}  // namespace rigfit::model
