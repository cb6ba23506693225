// A rig with one of its numbers changed a little, in its equilibrium: what
// sensitivities of modes and FRFs are made of.
//
// With R(u, p) = 0 the equilibrium, each side of the parameter is brought to rest by Newton's
// method from the rig's own equilibrium, with its tangent (equilibrium.h). Central differences of
// matrices assembled there (one-sided at a bound of zero) are dK/dp, dM/dp, dC/dp with the change
// of the equilibrium in them.
#pragma once

#include "model/algebra/numbers.h"
#include "model/linear/modes.h"
#include "model/scene/parameters.h"

namespace rigfit::model {

struct PerturbedEquilibrium {
  Scene scene;
  Chain chain;
  ChainState state;
};

/// Two values of a parameter, `low` <= `value` < `high`.
struct ParameterStep {
  double value = 0, low = 0, high = 0;
  [[nodiscard]] double width() const { return high - low; }
};

/// The rig at `step.low` and `step.high`, which come closer where the rig moves far.
struct Neighbours {
  ParameterStep step;
  std::array<PerturbedEquilibrium, 2> rigs;
  /// False: a scene beside this one has other unknowns (a plane of symmetry is lost), so that its
  /// matrices do not compare, or no equilibrium.
  bool comparable = true;
};
/// `modes`: of the scene, whose equilibrium converged; `tangent`: tangent_at_rest of it.
[[nodiscard]] Neighbours neighbours_of(const Scene& scene, const ChainModes& modes,
                                       const BorderedSolver& tangent,
                                       const ParameterAccess& access);

/// Stiffness and mass of a perturbed equilibrium in the motion `like` of the rig itself, without
/// modes.
[[nodiscard]] MotionModes motion_of(const PerturbedEquilibrium& rig, const MotionModes& like);

}  // namespace rigfit::model
