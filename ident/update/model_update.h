// Fits a scene's uncertain parameters to measured modes and FRFs.
//
// Unknowns p (stiffnesses, masses, tensions, spans ... of one scene in one or several states, such
// as several tensions) minimise
//
//   sum_pairs ((ln f_model(p) - ln f_measured) / s)^2 + such a sum over measured damping ratios
//   + sum_lines |ln(H_model(p) / H_measured) / s|^2 over measured FRFs
//   + sum_priors ((p - p0) / s_p)^2 + sum_inputs d^2
//
// over p and over d, by how many standard uncertainties each uncertain input (`UncertainInput`,
// place of hits) is off, s the relative standard uncertainty of the
// measured value and of the model together. Positive parameters are fitted in their logarithm.
// Derivatives are the model's own sensitivities (equilibrium's change included), the minimiser is
// Ceres' Levenberg-Marquardt; modes are assigned anew (mode_assignment.h) until the assignment
// stays, all over the range of the parameters (update_alternatives.h); fits to FRFs begin with
// their modes. A modelled mode is followed by its plane and its place among the modes of that
// plane, which crossings of planes do not change.
//
// Uncertainty, to first order: (J'J)^-1 of p and d together, so that an error of an input which the
// fit compensates does not count in a prediction. A source's part of a variance is the square of
// the parameter's covariance with it, in its standard uncertainty. The error of "auto" segments is
// subtracted from the frequencies (update_segments.cc). Sources: Friswell and Mottershead 1995;
// Mottershead, Link, Friswell 2011.
#pragma once

#include "ident/statistics/finding.h"
#include "ident/update/problem/update_data.h"
#include "ident/update/problem/update_result.h"

namespace rigfit::ident {

/// Throws model::SceneError for an unknown parameter, std::invalid_argument without a state or
/// parameter, or for invalid numbers.
[[nodiscard]] UpdateResult update_model(const std::vector<UpdateState>& states,
                                        const std::vector<FreeParameter>& free,
                                        const UpdateOptions& options = {});

/// Findings to be read before the numbers of a fit are used, most severe first.
[[nodiscard]] std::vector<Finding> fit_findings(const UpdateResult& result);

/// Describes each alternative but the first.
[[nodiscard]] std::vector<std::string> alternative_texts(const UpdateResult& result);

}  // namespace rigfit::ident
