// Few equations that may depend on each other: A x = b by its solution of least norm (complete
// orthogonal decomposition with column pivoting). Lengths of cables in line over a node that
// nothing else holds share one condition; the change is then shared among them.
#pragma once

#include <Eigen/Core>
#include <Eigen/QR>

namespace rigfit::model {

class LeastChange {
 public:
  /// A is k x k; a pivot below 1e-9 of the largest counts as none.
  void compute(const Eigen::MatrixXd& a);
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

 private:
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition_;
};

}  // namespace rigfit::model
