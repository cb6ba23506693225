// Displacements q and a few lengths l from
//   K q + B l = f,   G' q + D l = t
// through the inverse of K for every length. Few equations remain, which may depend on each other:
// they are solved with the least norm (complete orthogonal decomposition). Lengths of cables in
// line over a node that nothing else holds share one condition; the change is then shared among
// them.
#pragma once

#include <Eigen/QR>
#include <Eigen/SparseCore>

#include "model/algebra/envelope_matrix.h"
#include "model/algebra/numbers.h"

namespace rigfit::model {

class BorderedSolver {
 public:
  /// `border` B and `gradient` G: unknowns x lengths. `diagonal`: that of D, which has no others.
  void factor(const EnvelopeMatrix& k, MatrixXd border, const MatrixXd& gradient,
              const VectorXd& diagonal);
  /// From right sides f, t to q, l.
  void solve_in_place(VectorXd& q, VectorXd& l) const;
  [[nodiscard]] Index size() const { return border_.rows(); }  ///< unknowns

 private:
  EnvelopeFactor factor_;
  MatrixXd border_;
  Eigen::SparseMatrix<double> gradient_;  // few are not zero
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> small_;
};

}  // namespace rigfit::model
