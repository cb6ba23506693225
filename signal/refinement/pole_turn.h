// From the derivative columns of the modal basis to derivatives with respect to poles.
//
// The derivative of an FRF with respect to a pole is the column 1 / (s - p)^2 (modal_basis.h) times
// the FRF's residue R = a + i b: for the real and imaginary parts of the pole's change that is the
// turn T = [a -b; b a] of the column's two real halves, mode by mode. `residues` below are a column
// with as many coefficients (a_1, b_1, a_2, ...) as A has rows.
#pragma once

#include <Eigen/Core>

#include "signal/refinement/modal_noise.h"

namespace rigfit::signal {

/// T' A T.
[[nodiscard]] Eigen::MatrixXd turned(const Eigen::MatrixXd& A,
                                     const Eigen::Ref<const Eigen::VectorXd>& residues);
/// T' v.
[[nodiscard]] Eigen::VectorXd turned_vector(const Eigen::Ref<const Eigen::VectorXd>& v,
                                            const Eigen::Ref<const Eigen::VectorXd>& residues);
/// X T.
[[nodiscard]] Eigen::MatrixXd turned_columns(const Eigen::MatrixXd& X,
                                             const Eigen::Ref<const Eigen::VectorXd>& residues);
/// Sum over FRFs c of weight_c T_c' A T_c; residues from the first rows of `coefficients`.
[[nodiscard]] Eigen::MatrixXd summed_turns(const Eigen::MatrixXd& A,
                                           const Eigen::MatrixXd& coefficients,
                                           const Eigen::VectorXd& weight);

/// 1 / a_c of each FRF, 0 for one that takes no part.
[[nodiscard]] Eigen::VectorXd inverse_variance_of(const FrfNoise& noise);

}  // namespace rigfit::signal
