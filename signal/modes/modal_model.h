// Poles, shapes and residuals: what `modal` gives, what modes are compared with and UFF 55 is
// written from.
//
// H(i w) = sum_r [ psi_r L_r^T / (i w - p_r) + conj ] (receptance) + lower / (i w)^2 + upper;
// p_r = -zeta_r w_r + i w_r sqrt(1 - zeta_r^2). FRFs measured under an exponential window shared by
// force and response are this at i w + decay rate. An FRF set of unknown form is taken as
// receptance: poles and the likeness of shapes are right then, their units are not known. Source:
// Heylen, Lammens, Sas, Modal Analysis Theory and Testing.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "signal/numerics/estimate.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// A mode as one measured point shows it by itself.
struct ModeAtPoint {
  MeasuredPoint point;     ///< struck point or response, whichever vary
  Eigen::Index order = 0;  ///< place in the file, from 0
  Estimate frequency_hz;   ///< window damping removed
  Estimate damping_ratio;
  double misfit = 0;  ///< rms misfit over rms FRF within the half bandwidth, own pole
};

/// What changes from hit to hit, beyond noise (hit_scatter.h).
struct BetweenHits {
  int hits = 0;                 ///< that show the mode by themselves; 0: not known
  double frequency_std_hz = 0;  ///< standard deviation of one hit's frequency
  double damping_std = 0;
  bool beyond_noise = false;  ///< then value and standard deviation allow for it
};

struct IdentifiedMode {
  Estimate frequency_hz;   ///< undamped natural frequency |p| / 2 pi, window damping removed
  Estimate damping_ratio;  ///< window damping removed
  double damping_ratio_with_window = 0;  ///< as found, before the removal
  std::complex<double> pole_rad_s;       ///< corrected pole
  Eigen::VectorXcd shape;                ///< one per response
  Eigen::MatrixXd shape_std;             ///< responses x 2, of the real and imaginary parts
  Eigen::VectorXcd participation;        ///< one per input
  double modal_phase_collinearity = 0;   ///< MPC, 0..1
  double reconstruction_error = 0;       ///< rms misfit over rms FRF near the mode
  /// Share of the orders of the stabilisation diagram that show the mode, 0..1.
  double presence = 0;
  /// How far the residues of all FRFs together stand out of their noise: the root of the sum over
  /// FRFs of residue' covariance^-1 residue, over what chance gives a mode that is not there.
  double significance = 0;
  /// The window's decay rate is more than half of what was measured: the corrected damping is
  /// mostly a difference of large numbers and is not to be used.
  bool damping_dominated_by_window = false;
  /// What gave the pole: "global" (maximum likelihood of all FRFs, whose misfit looks like noise),
  /// "local" (fits of the lines around it, point by point, and their mean).
  std::string refinement = "global";
  /// Scatter of the frequency between points beyond the points' own errors (tau), drift included.
  double between_points_std_hz = 0;
  double between_points_std_damping = 0;
  Estimate trend_hz;  ///< change of frequency from one point to the next; NaN: fewer than 4 points
  bool has_trend = false;           ///< chance of such a trend without one below 1 %
  std::vector<ModeAtPoint> points;  ///< where several points were measured, in their order
  BetweenHits between_hits;
  bool doubtful = false;
  std::string doubt;  ///< why, for a person; empty when not doubtful
};

struct ModalModel {
  std::vector<IdentifiedMode> modes;  ///< by rising frequency
  std::vector<MeasuredPoint> responses, inputs;
  Eigen::MatrixXcd lower_residual, upper_residual;  ///< responses x inputs, receptance
  Eigen::MatrixXd frf_error;  ///< responses x inputs: rms misfit over rms FRF in the band
  FrfForm fitted_form = FrfForm::unknown;
  double exponential_decay_rate_1_s = 0;  ///< removed from every pole
  /// Covariance of (f_1, zeta_1, f_2, zeta_2, ...), 2N x 2N, Hz and 1.
  Eigen::MatrixXd pole_covariance;
  std::vector<Note> notes;
};

}  // namespace rigfit::signal
