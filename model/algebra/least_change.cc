#include "model/algebra/least_change.h"

namespace rigfit::model {

void LeastChange::compute(const Eigen::MatrixXd& a) {
  decomposition_.setThreshold(1e-9);
  decomposition_.compute(a);
}

Eigen::VectorXd LeastChange::solve(const Eigen::VectorXd& b) const {
  return decomposition_.solve(b);
}

}  // namespace rigfit::model
