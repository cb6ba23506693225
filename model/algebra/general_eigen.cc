#include "model/algebra/general_eigen.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace rigfit::model {

GeneralEigenpairs general_eigenpairs(const MatrixXd& matrix, const MatrixXd& right) {
  GeneralEigenpairs out;
  const Eigen::EigenSolver<MatrixXd> eigen(matrix);
  out.values = eigen.eigenvalues();
  out.vectors = eigen.eigenvectors();
  if (right.cols() > 0) {
    out.coordinates = out.vectors.partialPivLu().solve(right.cast<Complex>());
  }
  return out;
}

}  // namespace rigfit::model
