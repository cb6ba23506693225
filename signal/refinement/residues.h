// Residues, lower and upper residual of every FRF when the poles are known: linear least squares.
//
// Model and its columns: signal/refinement/modal_basis.h. The basis is the same for all FRFs, so
// one factor serves them all.
#pragma once

#include <Eigen/Core>

namespace rigfit::signal {

struct ResidueResult {
  Eigen::MatrixXcd residues;       ///< modes x FRFs, receptance (of the upper poles)
  Eigen::VectorXcd lower, upper;   ///< FRFs; lower / s^2 and upper, receptance
  Eigen::VectorXd squared_misfit;  ///< FRFs: sum over lines of |weight (H - model)|^2
  /// Condition number of the least squares problem with columns scaled to length 1; poles that the
  /// lines cannot tell apart make it large.
  double condition = 0;
};

/// `s`: lines (modal_basis.h), `power`: of the form of `H` (lines x FRFs), `line_weight`: lines,
/// empty: 1.
[[nodiscard]] ResidueResult fit_residues(const Eigen::Ref<const Eigen::VectorXcd>& s, int power,
                                         const Eigen::Ref<const Eigen::MatrixXcd>& H,
                                         const Eigen::Ref<const Eigen::VectorXcd>& poles,
                                         const Eigen::VectorXd& line_weight = {});

/// FRFs of given poles, residues (modes x FRFs) and residuals: lines x FRFs.
[[nodiscard]] Eigen::MatrixXcd synthesise(const Eigen::Ref<const Eigen::VectorXcd>& s, int power,
                                          const Eigen::Ref<const Eigen::VectorXcd>& poles,
                                          const Eigen::Ref<const Eigen::MatrixXcd>& residues,
                                          const Eigen::Ref<const Eigen::VectorXcd>& lower,
                                          const Eigen::Ref<const Eigen::VectorXcd>& upper);

/// Coefficients of the stacked basis (rows as its columns) as complex numbers, and back.
void unpack_coefficients(const Eigen::Ref<const Eigen::MatrixXd>& coefficients,
                         Eigen::MatrixXcd& residues, Eigen::VectorXcd& lower,
                         Eigen::VectorXcd& upper);
[[nodiscard]] Eigen::MatrixXd pack_coefficients(const Eigen::Ref<const Eigen::MatrixXcd>& residues,
                                                const Eigen::Ref<const Eigen::VectorXcd>& lower,
                                                const Eigen::Ref<const Eigen::VectorXcd>& upper);

}  // namespace rigfit::signal
