// Shapes, residues and residual terms of modes whose poles are known.
//
// Near its pole s^n R / (s - p) is p^n R / (s - p) and something smooth, so that the coefficient a
// of a window's fit (pole_fit.h) gives the residue R = a / p^n. Hits: the mean over hits, its
// variance from their scatter; else the fit's. R of several inputs is psi L^T by its nearest matrix
// of rank one. What the modes of a band leave of the FRFs is lower / s^2 + upper (least squares).
#pragma once

#include <Eigen/Core>

#include "signal/modal/modal_data.h"
#include "signal/modal/pole_fit.h"
#include "signal/modal/pole_sweep.h"
#include "signal/modes/modal_model.h"

namespace rigfit::signal {

/// Shape, participation and their uncertainty of pole `r` of a fit. `own`: each group's own pole,
/// where groups differ, else null. `mode.pole_rad_s` is set.
void fill_mode_shape(const ModalData& data, const FrfSet& frfs, const PoleFit& fit,
                     const Eigen::MatrixXcd& covariance, Eigen::Index r, const GroupPoles* own,
                     IdentifiedMode& mode);

/// Residual terms of the lines from `low_hz` to `high_hz`, and each FRF's misfit with them.
void fit_residuals(const FrfSet& frfs, double low_hz, double high_hz, ModalModel& model);

}  // namespace rigfit::signal
