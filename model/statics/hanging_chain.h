// The exact equilibrium of a cable's segments without bending stiffness: the cold start of every
// equilibrium, for any tension.
//
// Under weights at its nodes the force in segment i is H h + V_i u (h: horizontal, u: up), with
// V_(i+1) = V_i + weight of the node between. Its vector is l (1 / |F| + 1 / EA) F, and all of them
// add up to the chord: two equations for V_0 and the unstretched length (H given) or H (length
// given). Started from the catenary: H. M. Irvine, Cable Structures, 1981, ch. 1.
#pragma once

#include "model/chain/chain.h"
#include "model/scene/scene.h"
#include "model/statics/equilibrium_check.h"

namespace rigfit::model {

/// Every cable in the shape it hangs in between its drawn ends: `result.state` and the chain's
/// unstretched lengths. `with_bending`: tensions hold what bending carries. False: one is slack,
/// with the reason.
[[nodiscard]] bool hang_cables(Chain& chain, const Scene& scene, bool with_bending,
                               ChainEquilibrium& result);

}  // namespace rigfit::model
