// What a fit takes as exact: numbers of its scenes that are neither fitted nor stated with an
// uncertainty, and by how much each parameter changes for 1 % of each, to first order.
//
// With J of the answer and dr/d ln(x) the model's own sensitivity, d p = -(J'J)^-1 J' (dr/d ln(x))
// 0.01, all states together: one evaluation of the Jacobian. Lengths are the
// coordinates of all nodes, scaled together, as one ruler would. For the update, not for users.
#pragma once

#include <vector>

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

/// Fills `result.exact_inputs` and `exact_ends`; its uncertainty is stated with `problem`. Without
/// the changes (NaN) where the model has no derivatives.
void state_exact_inputs(const UpdateProblem& problem, const UpdateOptions& options,
                        const std::vector<UpdateMatch>& matches, UpdateResult& result);

}  // namespace rigfit::ident
