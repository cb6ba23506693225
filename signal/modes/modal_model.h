// Modal model: poles, shapes and residuals, as `modal` gives them and as UFF 55 is written.
//
// H(i w) = sum_r [ psi_r L_r^T / (i w - p_r) + conj ] (receptance) + lower / (i w)^2 + upper;
// p_r = -zeta_r w_r + i w_r sqrt(1 - zeta_r^2). FRFs measured under an exponential window shared by
// force and response are this at i w + decay rate. An FRF set of unknown form is treated as
// receptance: poles and MAC values are then right, while the units of shapes are unknown. Source:
// Heylen, Lammens, Sas, Modal Analysis Theory and Testing.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "signal/numerics/estimate.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// A mode as identified from one measured point alone.
struct ModeAtPoint {
  MeasuredPoint point;     ///< excitation point or response, whichever varies
  Eigen::Index order = 0;  ///< place in the file, from 0
  Estimate frequency_hz;   ///< window damping removed
  Estimate damping_ratio;
  double misfit = 0;  ///< rms misfit over rms FRF within the half bandwidth, own pole
};

/// Changes from hit to hit beyond noise (hit_scatter.h).
struct BetweenHits {
  int hits = 0;                 ///< number of hits that show the mode alone; 0: unknown
  double frequency_std_hz = 0;  ///< standard deviation of one hit's frequency
  double damping_std = 0;
  bool beyond_noise = false;  ///< then values and uncertainties allow for the changes
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
  /// Strength of the residues of all FRFs against noise: the root of the sum over FRFs of
  /// residue' covariance^-1 residue, over the value that a false mode reaches by chance.
  double significance = 0;
  /// The window's decay rate is more than half of the measured one: the corrected damping is a
  /// small difference of large numbers. Do not use it.
  bool damping_dominated_by_window = false;
  /// Source of the pole: "global" (maximum likelihood of all FRFs, with a misfit like noise) or
  /// "local" (mean over points of fits to the lines around it).
  std::string refinement = "global";
  /// Scatter of the frequency between points beyond the points' own errors (tau), drift included.
  double between_points_std_hz = 0;
  double between_points_std_damping = 0;
  Estimate trend_hz;  ///< change of frequency from one point to the next; NaN: fewer than 4 points
  bool has_trend = false;           ///< the trend would arise by chance in less than 1 %
  std::vector<ModeAtPoint> points;  ///< by measured point; empty for a single one
  BetweenHits between_hits;
  bool doubtful = false;
  std::string doubt;  ///< reason in words; empty when not doubtful
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
