// Poles, shapes and residuals: what `modal` gives, what modes are compared with and UFF 55 is
// written from.
//
// H(i w) = sum_r [ psi_r L_r^T / (i w - p_r) + conj ] (receptance) + lower / (i w)^2 + upper;
// p_r = -zeta_r w_r + i w_r sqrt(1 - zeta_r^2). Source: Heylen, Lammens, Sas, Modal Analysis Theory
// and Testing.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "signal/estimate.h"
#include "signal/frf_set.h"

namespace rigfit::signal {

struct IdentifiedMode {
  Estimate frequency_hz;   ///< undamped natural frequency |p| / 2 pi, window damping removed
  Estimate damping_ratio;  ///< window damping removed
  double damping_ratio_with_window = 0;  ///< as found, before the removal
  std::complex<double> pole_rad_s;       ///< corrected pole
  Eigen::VectorXcd shape;                ///< one per response
  Eigen::MatrixXd shape_std;             ///< responses x 2, of the real and imaginary parts
  Eigen::VectorXcd participation;        ///< one per input
  double modal_phase_collinearity = 0;   ///< MPC, 0..1
  double reconstruction_error = 0;       ///< rms misfit over rms FRF near the mode, 0..
  bool doubtful = false;
  std::string doubt;  ///< why, for a person; empty when not doubtful
};

struct ModalModel {
  std::vector<IdentifiedMode> modes;  ///< by rising frequency
  std::vector<MeasuredPoint> responses, inputs;
  Eigen::MatrixXcd lower_residual, upper_residual;  ///< responses x inputs, receptance
  FrfForm fitted_form = FrfForm::unknown;
  double exponential_decay_rate_1_s = 0;  ///< removed from every pole
  /// Covariance of (f_1, zeta_1, f_2, zeta_2, ...), 2N x 2N, Hz and 1.
  Eigen::MatrixXd pole_covariance;
  std::vector<Note> notes;
};

}  // namespace rigfit::signal
