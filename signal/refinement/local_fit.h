// Poles of one mode, or of few that overlap, on the lines around them, with everything else as a
// smooth background.
//
// On the lines s_k of a window, column c of the FRFs is
//   H_c(s) = sum_r a_rc / (s - p_r) + sum_q a_qc / (s - p_q) + sum_{j=0..d} b_jc x^j,
// p_r free, p_q of neighbours and fixed, x the frequency scaled to -1..1 in the window. The factor
// s^n of mobility and accelerance, conjugate poles, modes further away and residual terms are
// smooth there and part of the polynomial; a_rc is the receptance residue times p_r^n. The model is
// analytic in the poles, so that complex least squares applies: amplitudes and background are
// eliminated, poles move by steps (estimation/pole_steps.h) that never raise
//   sum_c w_c sum_k |H_c(s_k) - model|^2.
// Source: Ewins, Modal Testing, 2nd ed., sec. 4.3 (single-mode methods and the compensation for
// neighbouring modes).
#pragma once

#include <Eigen/Core>

namespace rigfit::signal {

struct LocalFit {
  Eigen::VectorXcd poles;       ///< free poles on the s of the lines, 1/s
  Eigen::MatrixXcd amplitudes;  ///< free poles x columns: a_rc
  Eigen::MatrixXcd residual;    ///< lines x columns
  Eigen::VectorXd misfit;       ///< columns: sum over lines of |residual|^2
  /// Free poles x columns: by how much `misfit` rises without that pole, the others kept.
  Eigen::MatrixXd gain;
  /// Covariance of the free poles for w_c = 1 / variance of a column's complex noise, white over
  /// lines.
  Eigen::MatrixXcd covariance;
  /// The same from what the fit leaves at each line of all columns together (White, Econometrica 48
  /// (1980) 817): for noise that goes with |H| and is common to columns. Scatters when lines are
  /// few.
  Eigen::MatrixXcd robust_covariance;
  Eigen::Index freedom = 0;  ///< complex values a column less unknowns: lines - poles - d - 1
  bool usable = false;       ///< false: too few lines, or columns of the model that depend
};

/// `s`: lines of the window; `H`: lines x columns; `weight`: w_c; `start`: free poles; `fixed`:
/// neighbours; `background_order`: d; `step_in_std`: where the steps of the poles end. Poles stay
/// stable (Re p below Re s) and, in Im, within the window.
[[nodiscard]] LocalFit fit_locally(const Eigen::Ref<const Eigen::VectorXcd>& s,
                                   const Eigen::Ref<const Eigen::MatrixXcd>& H,
                                   const Eigen::Ref<const Eigen::VectorXd>& weight,
                                   const Eigen::Ref<const Eigen::VectorXcd>& start,
                                   const Eigen::Ref<const Eigen::VectorXcd>& fixed,
                                   int background_order = 2, double step_in_std = 1e-2);

}  // namespace rigfit::signal
