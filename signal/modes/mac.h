// Similarity of mode shapes (MAC) and closeness of a shape to a real one (MPC).
//
// MAC(a, b) = |a^H b|^2 / (a^H a b^H b), 1: proportional. AutoMAC compares a set with itself.
// MPC (modal phase collinearity), from the 2 x 2 scatter of the real and imaginary parts about 0:
// ((Sxx - Syy)^2 + 4 Sxy^2) / (Sxx + Syy)^2, 1: all components in phase or in opposition (a normal
// mode), 0: a shape that travels. Both do not depend on a complex scale of the shape.
// Source: Allemang, The modal assurance criterion, 2003; Pappa, Elliott, Schenk 1993.
#pragma once

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

/// MAC of two shapes; 0 when either is zero.
[[nodiscard]] double mac(const Ref<const VectorXcd>& a, const Ref<const VectorXcd>& b);

/// MAC of shapes in columns with each other: symmetric, ones on the diagonal.
[[nodiscard]] MatrixXd auto_mac(const Ref<const MatrixXcd>& shapes);

/// MPC of a shape, 0..1; 0 for a zero shape.
[[nodiscard]] double modal_phase_collinearity(const Ref<const VectorXcd>& shape);

}  // namespace rigfit::signal
