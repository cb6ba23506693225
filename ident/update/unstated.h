// What a fit takes as exact, as rows of the budget of the same problem that no interval holds: 1 %
// of every length, mass, tension and stiffness that is neither fitted nor stated, a point mass of
// 1 % of a member that the scene lacks, and supports that turn as the scenes say.
//
// Each is one further column N_k of the Jacobian at the answer, and moves the parameters by A N_k
// (posterior.h). Ends are a fixity k / (k_h + k), 0 pinned and 1 clamped, in which frequencies are
// nearly straight (coordinate.h): their column is taken half way between the scene's and the other
// end, and they move within what the data leave of it (95 %). For fits to modes and FRFs; ends and
// point masses for modes alone. For the update, not for users.
#pragma once

#include <vector>

#include "ident/update/likelihood.h"

namespace rigfit::ident {

/// Fills `result.exact_inputs`, of a stated result.
void state_exact_inputs(const Likelihood& likelihood, const std::vector<UpdateMatch>& matches,
                        UpdateResult& result);

}  // namespace rigfit::ident
