// All eigenvalues and eigenvectors of a real square matrix, with the solver's heavy templates in
// one place.
#pragma once

#include "model/algebra/numbers.h"

namespace rigfit::model {

struct GeneralEigenpairs {
  VectorXcd values;
  MatrixXcd vectors;      ///< columns
  MatrixXcd coordinates;  ///< vectors^-1 right: `right` expressed in the vectors
};

/// `right` may have no columns.
[[nodiscard]] GeneralEigenpairs general_eigenpairs(const MatrixXd& matrix, const MatrixXd& right);

}  // namespace rigfit::model
