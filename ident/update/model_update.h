// Fitting a scene's uncertain parameters to measured modes.
//
// Unknowns p (stiffnesses, masses, tensions, spans ... of one scene in one or several states, such
// as several tensions) minimise
//
//   sum_pairs rho((ln f_model(p) - ln f_measured) / s) + the same of damping ratios where measured
//   + the same of shapes where asked for (both of unit length, the model's sign)
//   + sum_lines rho(Re, Im of ln(H_model(p) / H_measured) / s) of FRFs where measured
//   + sum_priors ((p - p0) / s_p)^2
//
// with Huber's rho, s the relative standard uncertainty of the measured value and of the model
// together. Positive parameters are fitted in their logarithm. Derivatives are the model's own
// sensitivities (equilibrium's change included), the minimiser is Ceres' Levenberg-Marquardt; modes
// are paired anew (mode_pairing.h) until the pairs stay, from several starts. A modelled mode is
// followed by its plane and its place among the modes of that plane, which crossings of planes do
// not change.
//
// Uncertainty, to first order: the data's scatter and the priors through (J'J)^-1; what is known of
// the scene but not fitted (`UncertainInput`) and the error of the segments through the shift
// -(J'J)^-1 J' (d residuals) that it causes. The error of segments that a
// scene leaves to the program is taken off the frequencies, what may be left of it counts
// (update_segments.h); that of all others is 4/3 of their difference
// to a model of twice as many segments (Richardson, second order; a fourth-order error comes out a
// quarter too large). Shifts of one source are shared by all parameters and all predictions, so
// that what the fit makes up for is not counted against what it predicts.
// Sources: Friswell and Mottershead 1995; Mottershead, Link, Friswell 2011.
#pragma once

#include <limits>
#include <vector>

#include "ident/update/problem/update_data.h"
#include "ident/update/problem/update_options.h"
#include "ident/update/problem/update_result.h"

namespace rigfit::ident {

/// Throws model::SceneError for a parameter that is not there, std::invalid_argument for no state,
/// no parameter, or numbers that make no sense.
[[nodiscard]] UpdateResult update_model(const std::vector<UpdateState>& states,
                                        const std::vector<FreeParameter>& free,
                                        const UpdateOptions& options = {});

/// The modes of the states' scenes as they are, paired with what was measured.
struct PairedModes {
  std::vector<UpdatedPair> pairs;
  std::vector<UpdatedUnpaired> unpaired;
  double rms_relative_error = std::numeric_limits<double>::quiet_NaN();
};
[[nodiscard]] PairedModes compare_with_measured(const std::vector<UpdateState>& states,
                                                const UpdateOptions& options = {});

}  // namespace rigfit::ident
