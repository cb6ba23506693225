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
  /// Ten times as wide: for what is found anew on both sides, eigenvalues to 1e-10.
  [[nodiscard]] ParameterStep wider() const {
    return {value, value + 10 * (low - value), value + 10 * (high - value)};
  }
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

/// A motion of the rig on both sides of the parameter, without modes, and the rates of its
/// matrices.
struct MotionRates {
  std::array<MotionModes, 2> sides;
  EnvelopeMatrix stiffness, mass;
};
/// `motion`: of the rig itself.
[[nodiscard]] MotionRates motion_rates(const Neighbours& near, const MotionModes& motion);
/// (high - low) / width
[[nodiscard]] EnvelopeMatrix rate_of(const EnvelopeMatrix& low, const EnvelopeMatrix& high,
                                     double width);

}  // namespace rigfit::model
