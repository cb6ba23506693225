// Covariance of fitted modes under the noise that the FRFs have, and how far each stands out of it.
//
// For the poles (J'WJ)^-1 J'W C W J (J'WJ)^-1, J the derivatives outside the space of the residues'
// columns, C the modelled covariance of the errors: noise of each FRF's own, noise common to the
// FRFs of an input (which goes with |H|), and the correlation of lines under an exponential window.
// The error of a residue is the filter of its column on the FRF's error less what the poles' errors
// carry into it; the variances of both parts count. Source: Pintelon, Schoukens, System
// Identification, 2nd ed., ch. 9.
#pragma once

#include <Eigen/Core>

#include "signal/refinement/modal_noise.h"
#include "signal/refinement/modal_refine.h"

namespace rigfit::signal {

struct ModalCovariance {
  /// Of (Re p_1, Im p_1, Re p_2, ...).
  Eigen::MatrixXd poles;
  /// modes x FRFs, standard deviations of the real and imaginary parts of the residues.
  Eigen::MatrixXd residue_std_re, residue_std_im;
  /// Modes: sum over FRFs of residue' covariance^-1 residue at fixed poles, less what noise common
  /// to the FRFs of an input can imitate; about 2 FRFs for a mode that is not there.
  Eigen::VectorXd significance;
  bool full_rank = true;  ///< false: poles cannot be told apart, the covariance is empty
};

[[nodiscard]] ModalCovariance modal_covariance(const FrfLines& data, const FrfNoise& noise,
                                               const ModalRefineResult& fit);

/// `significance` and `full_rank` alone, which cost far less than the covariances. `model`: the
/// fit's (fitted_frfs()).
[[nodiscard]] ModalCovariance modal_significance(const FrfLines& data, const FrfNoise& noise,
                                                 const ModalRefineResult& fit,
                                                 const Eigen::Ref<const Eigen::MatrixXcd>& model);

/// Errors of (Re p_1, Im p_1, Re p_2, ...) that the error of each FRF (lines x FRFs) makes to first
/// order: parts of the poles x FRFs, to be added up. Empty when the poles cannot be told apart.
[[nodiscard]] Eigen::MatrixXd pole_errors(const FrfLines& data, const FrfNoise& noise,
                                          const ModalRefineResult& fit,
                                          const Eigen::Ref<const Eigen::MatrixXcd>& error);

}  // namespace rigfit::signal
