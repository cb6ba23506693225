// Maximum-likelihood fit of all modal parameters to FRFs with error bars, covariance of the fitted
// modes under the noise that the FRFs have, and how far each stands out of it.
//
// Minimises sum_k w_k^2 sum_c |H_kc - model_kc(p, R, lower, upper)|^2 / a_c over the poles p and,
// at every step, over all residues and residuals, which enter linearly (estimation/pole_steps.h).
// The basis functions and the line weights w are common to all FRFs, hence a step costs one Gram
// matrix and two products with the FRFs, whatever their number. modal_noise.h gives the weights and
// the noise behind them.
//
// For the poles (J'WJ)^-1 J'W C W J (J'WJ)^-1, J the derivatives outside the space of the residues'
// columns, C the modelled covariance of the errors: noise of each FRF's own, noise common to the
// FRFs of an input (which goes with |H|), and the correlation of lines under an exponential window.
// The error of a residue is the filter of its column on the FRF's error less what the poles' errors
// carry into it; the variances of both parts count. Source: Pintelon, Schoukens, System
// Identification, 2nd ed., ch. 9.
#pragma once

#include "signal/estimation/pole_steps.h"
#include "signal/refinement/modal_noise.h"

namespace rigfit::signal {

/// Data of the fit: lines x FRFs along s (modal_basis.h).
struct FrfLines {
  VectorXcd s;
  int power = 0;
  MatrixXcd H;
  Index inputs = 1;
  /// Lines x terms: smooth functions that every FRF may hold besides modes and residuals
  /// (signal/modal/band_background.h); empty: none.
  MatrixXcd background;
};

struct ModalRefineResult {
  VectorXcd poles;     ///< structure's poles, rad/s (s contains the window)
  MatrixXcd residues;  ///< modes x FRFs
  VectorXcd lower, upper;
  MatrixXcd background;  ///< terms of FrfLines::background x FRFs
  StepsEnd end = StepsEnd::iteration_limit;
  int iterations = 0;
  VectorXd leverage;  ///< lines: share of the freedom used, mean over FRFs
};

/// Lines x FRFs of a fit, background included.
[[nodiscard]] MatrixXcd fitted_frfs(const FrfLines& data, const ModalRefineResult& fit);

/// Fits from the poles `start` (positive imaginary part). FRFs with infinite `noise.column` do not
/// influence the poles. `steps`: iterations and the step that ends them; the rest is set here.
[[nodiscard]] ModalRefineResult refine_modes(const FrfLines& data, const FrfNoise& noise,
                                             const Ref<const VectorXcd>& start,
                                             PoleStepOptions steps = {});

struct ModalCovariance {
  /// Of (Re p_1, Im p_1, Re p_2, ...).
  MatrixXd poles;
  /// modes x FRFs, standard deviations of the real and imaginary parts of the residues.
  MatrixXd residue_std_re, residue_std_im;
  /// Modes: sum over FRFs of residue' covariance^-1 residue at fixed poles, less what noise common
  /// to the FRFs of an input can imitate; about 2 FRFs for a mode that is not there.
  VectorXd significance;
  bool full_rank = true;  ///< false: poles cannot be told apart, the covariance is empty
};

/// `significance_alone`: that and `full_rank`, which cost far less than the covariances.
[[nodiscard]] ModalCovariance modal_covariance(const FrfLines& data, const FrfNoise& noise,
                                               const ModalRefineResult& fit,
                                               bool significance_alone = false);

/// Errors of (Re p_1, Im p_1, Re p_2, ...) that the error of each FRF (lines x FRFs) makes to first
/// order: parts of the poles x FRFs, to be added up. Empty when the poles cannot be told apart.
[[nodiscard]] MatrixXd pole_errors(const FrfLines& data, const FrfNoise& noise,
                                   const ModalRefineResult& fit, const Ref<const MatrixXcd>& error);

}  // namespace rigfit::signal
