// All eigenvalues and eigenvectors of a real square matrix, with the solver's heavy templates in
// one place.
#pragma once

#include <Eigen/Core>

namespace rigfit::model {

struct GeneralEigenpairs {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;      ///< columns
  Eigen::MatrixXcd coordinates;  ///< vectors^-1 right: `right` expressed in the vectors
};

/// `right` may have no columns.
[[nodiscard]] GeneralEigenpairs general_eigenpairs(const Eigen::MatrixXd& matrix,
                                                   const Eigen::MatrixXd& right);

}  // namespace rigfit::model
