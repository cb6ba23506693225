// Maximum-likelihood fit of all modal parameters to FRFs with error bars.
//
// Minimises sum_k w_k^2 sum_c |H_kc - model_kc(p, R, lower, upper)|^2 / a_c over the poles p and,
// at every step, over all residues and residuals, which enter linearly (estimation/pole_steps.h).
// The basis functions and the line weights w are common to all FRFs, hence a step costs one Gram
// matrix and two products with the FRFs, whatever their number. modal_noise.h gives the weights and
// the noise behind them, modal_covariance.h the uncertainty of the result. Source: Pintelon,
// Schoukens, System Identification, 2nd ed., ch. 9.
#pragma once

#include <Eigen/Core>

#include "signal/estimation/pole_steps.h"
#include "signal/refinement/modal_noise.h"

namespace rigfit::signal {

/// Data of the fit: lines x FRFs along s (modal_basis.h).
struct FrfLines {
  Eigen::VectorXcd s;
  int power = 0;
  Eigen::MatrixXcd H;
  Eigen::Index inputs = 1;
  /// Lines x terms: smooth functions that every FRF may hold besides modes and residuals
  /// (signal/modal/band_background.h); empty: none.
  Eigen::MatrixXcd background;
};

struct ModalRefineOptions {
  int max_iterations = 50;
  /// Stops when a step changes no pole by more than this times its standard deviation.
  double step_tolerance = 1e-3;
};

struct ModalRefineResult {
  Eigen::VectorXcd poles;     ///< structure's poles, rad/s (s contains the window)
  Eigen::MatrixXcd residues;  ///< modes x FRFs
  Eigen::VectorXcd lower, upper;
  Eigen::MatrixXcd background;  ///< terms of FrfLines::background x FRFs
  StepsEnd end = StepsEnd::iteration_limit;
  int iterations = 0;
  double cost = 0;           ///< the minimised sum
  Eigen::VectorXd leverage;  ///< lines: share of the freedom used, mean over FRFs
};

/// Columns of the linear unknowns, each line multiplied by `line_weight`: those of modal_basis.h,
/// then two real columns per background term.
[[nodiscard]] Eigen::MatrixXd weighted_basis(const FrfLines& data,
                                             const Eigen::Ref<const Eigen::VectorXcd>& poles,
                                             const Eigen::Ref<const Eigen::VectorXd>& line_weight);

/// Lines x FRFs of a fit, background included.
[[nodiscard]] Eigen::MatrixXcd fitted_frfs(const FrfLines& data, const ModalRefineResult& fit);

/// Fits from the poles `start` (positive imaginary part). FRFs with infinite `noise.column` do not
/// influence the poles.
[[nodiscard]] ModalRefineResult refine_modes(const FrfLines& data, const FrfNoise& noise,
                                             const Eigen::Ref<const Eigen::VectorXcd>& start,
                                             const ModalRefineOptions& options = {});

}  // namespace rigfit::signal
