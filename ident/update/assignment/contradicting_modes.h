// Measured modes that contradict all the others.
//
// Huber's loss bounds what a wrong frequency does to a fit, but not where that frequency alone
// determines a parameter (high leverage): the fit then follows it and the others seem wrong. Where
// stated uncertainties are exceeded threefold in the mean, pairs are left out one at a time, each
// time the one whose loss leaves the least chi-squared (deletion diagnostics: Cook and Weisberg,
// Residuals and Influence in Regression, 1982, ch. 2), and stay out if the rest then agrees within
// its uncertainties. At most a fifth of the pairs; two degrees of freedom must be left.
#pragma once

#include "ident/update/problem/update_solver.h"

namespace rigfit::ident {

/// Whether a fit to modes alone, with stated uncertainties, exceeds them threefold in the mean.
[[nodiscard]] bool is_misfit(const UpdateProblem& problem, const UpdateSolution& solution);

/// For fits to modes alone, with stated uncertainties; else, and when no such pairs explain the
/// misfit, `solution` stays as it is. What is left out goes to its `matches.unpaired` with the
/// reason; its cost is not touched.
void leave_out_contradictions(const UpdateProblem& problem, const UpdateOptions& options,
                              UpdateSolution& solution);

}  // namespace rigfit::ident
