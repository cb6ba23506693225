// End conditions that a fit takes as exact: nodes that are pinned, clamped or on given springs that
// are neither fitted nor stated, and what the answer changes by where they turn differently.
//
// The nodes of one kind get rotational springs k = c rho / (1 - rho) across their member, with the
// fixity rho from 0 (pinned) to 1 (clamped) and c = 3 EI / L + sqrt(EI T), of which an end
// condition is half way for a beam and for a string alike; given springs get rho / (1 - rho) of
// themselves. One rho serves all nodes of a kind, beside the fitted parameters:
//   rho' = rho - J_p' r / |J_p|^2,   J_p = J_rho - J (J'J)^-1 J' J_rho,   std(rho) = 1 / |J_p|,
// to first order from the answer; where rho within its 95 % interval moves a parameter by a
// standard uncertainty or more, from a fit with rho free. What is stated is the change by the rho
// that explains the data best (none, where no fit is better than the answer) and the largest one by
// a rho in its 95 % interval. Data that tell the ends apart leave no such change. Source of rho:
// Monforton and Wu, J. Struct. Div. ASCE 89 ST6 (1963) 13. For the update, not for users.
#pragma once

#include <vector>

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

/// Fills `result.exact_ends`; its uncertainty is stated with `problem`. None for data other than
/// modes, and for nodes whose members do not lie along one axis.
void state_exact_ends(const UpdateProblem& problem, const UpdateOptions& options,
                      const std::vector<UpdateMatch>& matches, UpdateResult& result);

}  // namespace rigfit::ident
