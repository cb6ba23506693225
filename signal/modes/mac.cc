#include "signal/modes/mac.h"

#include <cmath>

namespace rigfit::signal {

double mac(const Eigen::Ref<const Eigen::VectorXcd>& a,
           const Eigen::Ref<const Eigen::VectorXcd>& b) {
  // Shapes are scaled first: squares of residues in SI may underflow.
  const double norm_a = a.stableNorm(), norm_b = b.stableNorm();
  if (norm_a == 0 || norm_b == 0) return 0;
  return std::norm((a / norm_a).dot(b / norm_b));
}

Eigen::MatrixXd mac_matrix(const Eigen::Ref<const Eigen::MatrixXcd>& a,
                           const Eigen::Ref<const Eigen::MatrixXcd>& b) {
  Eigen::MatrixXd result(a.cols(), b.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j) {
    for (Eigen::Index i = 0; i < a.cols(); ++i) result(i, j) = mac(a.col(i), b.col(j));
  }
  return result;
}

double modal_phase_collinearity(const Eigen::Ref<const Eigen::VectorXcd>& shape) {
  const double norm = shape.stableNorm();
  if (norm == 0) return 0;
  const Eigen::VectorXcd unit = shape / norm;
  // With Sxx + Syy = 1, (Sxx - Syy) + 2 i Sxy is the sum of squares of the components.
  return std::norm(unit.cwiseProduct(unit).sum());
}

}  // namespace rigfit::signal
