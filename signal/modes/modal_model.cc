#include "signal/modes/modal_model.h"

namespace rigfit::signal {

double mac(const Ref<const VectorXcd>& a, const Ref<const VectorXcd>& b) {
  // Shapes are scaled first: squares of residues in SI may underflow.
  const double norm_a = a.stableNorm(), norm_b = b.stableNorm();
  if (norm_a == 0 || norm_b == 0) return 0;
  return std::norm((a / norm_a).dot(b / norm_b));
}

MatrixXd auto_mac(const Ref<const MatrixXcd>& shapes) {
  MatrixXd result(shapes.cols(), shapes.cols());
  for (Index j = 0; j < shapes.cols(); ++j) {
    for (Index i = 0; i < shapes.cols(); ++i) result(i, j) = mac(shapes.col(i), shapes.col(j));
  }
  return result;
}

double modal_phase_collinearity(const Ref<const VectorXcd>& shape) {
  const double norm = shape.stableNorm();
  if (norm == 0) return 0;
  const VectorXcd unit = shape / norm;
  // With Sxx + Syy = 1, (Sxx - Syy) + 2 i Sxy is the sum of squares of the components.
  return std::norm(unit.cwiseProduct(unit).sum());
}

}  // namespace rigfit::signal
