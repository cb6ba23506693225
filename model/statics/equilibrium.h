// Where a chain rests: R(x, L) = 0 with the unstretched length L_k of each tensioned cable a
// bordered unknown, tension_k(x, L) = T_k.
//
// Newton's method from the exact hanging chain of every cable (hanging_chain.cc). The geometric
// stiffness takes the axial force extrapolated by the last step, not the one of the new geometry:
// stiff chains then converge from far (D. Magisano et al., Comput. Methods Appl. Mech. Engrg. 313,
// 2017). Where that fails, the cables' bending stiffness, the junctions' freedom and the beams'
// weight are let in step by step. Accepted on the largest unbalanced force and on the last step's
// size; then the tangent must be positive definite in every motion, and every cable pull: slack,
// mechanism and buckling are told apart and named, with what to change.
#pragma once

#include "model/algebra/bordered_solver.h"
#include "model/algebra/numbers.h"
#include "model/chain/assembly.h"
#include "model/chain/chain.h"
#include "model/scene/scene.h"
#include "model/statics/equilibrium_result.h"

namespace rigfit::model {

/// A motion about the equilibrium.
struct RestMotion {
  Motion motion = Motion::space;
  std::unique_ptr<Assembly> assembly;  ///< energies and forces of the chain at rest
  EnvelopeMatrix stiffness;
};

/// An equilibrium that is sought; `members` stays empty.
struct ChainEquilibrium : Equilibrium {
  ChainState state;
  std::vector<RestMotion> motions;  ///< of a converged one: all that have unknowns, the plane first
};

/// Sets the chain's unstretched lengths, settles its joints stress-free at equilibrium. `scene`
/// gives names.
[[nodiscard]] ChainEquilibrium find_equilibrium(Chain& chain, const Scene& scene);

/// Every cable in the shape it hangs in between its drawn ends (hanging_chain.cc): `result.state`
/// and the chain's unstretched lengths. `with_bending`: tensions hold what bending carries. False:
/// one is slack, with the reason.
[[nodiscard]] bool hang_cables(Chain& chain, const Scene& scene, bool with_bending,
                               ChainEquilibrium& result);

/// Sets `status`, `reason` and `motions` of a settled state whose forces balance.
void judge_rest(const Chain& chain, const Scene& scene, ChainEquilibrium& result);

/// Mean of the segments' axial forces along a member, N.
[[nodiscard]] double mean_force(const Chain& chain, const ChainMember& member,
                                const VectorXd& axial);

/// What to change about a slack cable.
[[nodiscard]] const char* how_to_tighten(const Member& cable);

/// The tangent of a chain at rest, its joints free again to settle.
[[nodiscard]] BorderedSolver tangent_at_rest(Chain chain, const ChainState& state);

/// Brings a chain to rest that differs little from one at rest, whose `state` it starts from and
/// whose tangent is `near`: the state, the lengths of cables with a tension, settled joints. False:
/// not found.
[[nodiscard]] bool come_to_rest(Chain& chain, ChainState& state, const BorderedSolver& near);

/// Where a settled chain rests under additional dead loads, if that is found. `load`: generalised
/// forces in the assembly's unknowns, N and N m. By load steps, none of which moves anything by
/// more than a quarter of the rig or ends in an unstable state: a slender beam that its load bends
/// through ninety degrees has other equilibria too.
[[nodiscard]] std::optional<ChainState> loaded_state(const Assembly& assembly,
                                                     const ChainState& equilibrium,
                                                     const VectorXd& load);

/// What a user sees of it, in the scene's axes.
[[nodiscard]] Equilibrium describe(const Chain& chain, const ChainEquilibrium& equilibrium,
                                   const Scene& scene);

}  // namespace rigfit::model
