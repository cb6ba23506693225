// Whether a balanced state is one to rest in: every cable pulls, and the tangent is positive
// definite in every motion. Slack, mechanism and buckling are told apart and named, with what to
// change.
#pragma once

#include "model/algebra/numbers.h"
#include "model/chain/assembly.h"
#include "model/chain/chain.h"
#include "model/scene/scene.h"
#include "model/statics/equilibrium_result.h"

namespace rigfit::model {

/// An equilibrium that is sought (equilibrium.h); `members` stays empty.
struct ChainEquilibrium : Equilibrium {
  ChainState state;
};

/// A motion about the equilibrium.
struct RestMotion {
  Motion motion = Motion::space;
  std::unique_ptr<Assembly> assembly;  ///< energies and forces of the chain at rest
  EnvelopeMatrix stiffness;
};

/// Sets `status` and `reason` of a settled state whose forces balance. The motions it looked at, of
/// a state that it finds converged: all that have unknowns, in the plane of symmetry first.
std::vector<RestMotion> judge_rest(const Chain& chain, const Scene& scene,
                                   ChainEquilibrium& result);

/// Mean of the segments' axial forces along a member, N.
[[nodiscard]] double mean_force(const Chain& chain, const ChainMember& member,
                                const VectorXd& axial);

/// What to change about a slack cable.
[[nodiscard]] const char* how_to_tighten(const Member& cable);

}  // namespace rigfit::model
