// How alike mode shapes are, and how real one is.
//
// MAC(a, b) = |a^H b|^2 / (a^H a b^H b), 1: proportional. AutoMAC: of one set with itself.
// MPC (modal phase collinearity), from the 2 x 2 scatter of the real and imaginary parts about 0:
// ((Sxx - Syy)^2 + 4 Sxy^2) / (Sxx + Syy)^2, 1: all components in phase or in opposition (a normal
// mode), 0: a shape that travels. Both are free of a complex scale of the shape.
// Source: Allemang, The modal assurance criterion, 2003; Pappa, Elliott, Schenk 1993.
#pragma once

#include <Eigen/Core>

namespace rigfit::signal {

/// 0 when either shape is zero.
[[nodiscard]] double mac(const Eigen::Ref<const Eigen::VectorXcd>& a,
                         const Eigen::Ref<const Eigen::VectorXcd>& b);

/// Shapes in columns: a.cols() x b.cols().
[[nodiscard]] Eigen::MatrixXd mac_matrix(const Eigen::Ref<const Eigen::MatrixXcd>& a,
                                         const Eigen::Ref<const Eigen::MatrixXcd>& b);

/// Symmetric with ones on the diagonal.
[[nodiscard]] inline Eigen::MatrixXd auto_mac(const Eigen::Ref<const Eigen::MatrixXcd>& shapes) {
  return mac_matrix(shapes, shapes);
}

/// 0 for a zero shape.
[[nodiscard]] double modal_phase_collinearity(const Eigen::Ref<const Eigen::VectorXcd>& shape);

}  // namespace rigfit::signal
