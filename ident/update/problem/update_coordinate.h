// The unknowns of a fit as its solver sees them, and what a scene's parameter is by its name.
#pragma once

#include <string>
#include <utility>

#include "model/scene/scene.h"

namespace rigfit::ident {

/// One unknown as it is fitted: q = ln(value) where the value is positive by nature, else
/// value / scale.
struct UpdateCoordinate {
  int parameter = 0;  ///< index into the free parameters
  /// What is known to its standard uncertainty, q in units of it: index into the inputs, or into
  /// the forces that lines of FRFs share (update_nuisances.cc); -1: neither.
  int input = -1, force = -1;
  int state = -1;  ///< -1: shared
  bool logarithmic = true;
  double scale = 1;
  double start = 0, low = 0, high = 0;  ///< q
  double prior = 0, prior_std = 0;      ///< q; prior_std 0: none
  double half_held = 0;                 ///< see step_by_fixity; 0: q itself

  [[nodiscard]] double value(double q) const;
  [[nodiscard]] double derivative(double q) const;  ///< d value / d q
  [[nodiscard]] double coordinate(double value) const;

  /// What the solver steps in: q, or the fixity value / (half + value) of a spring, in which
  /// frequencies are nearly straight. In ln(value) they lie flat on either side, and steps run off.
  [[nodiscard]] double step(double q) const;
  [[nodiscard]] double from_step(double u) const;        ///< q
  [[nodiscard]] double step_derivative(double u) const;  ///< d q / d u
  [[nodiscard]] std::pair<double, double> step_bounds() const { return {step(low), step(high)}; }
  /// Makes the step the fixity of a rotational spring with logarithmic q. `half` is the stiffness
  /// half way between a free and a held end. Does nothing where that is 0, or so far off that the
  /// bounds' fixities are 0 and 1.
  void step_by_fixity(double half);
};

/// Whether a parameter may have any sign: coordinates of nodes, a load cell's zero, a change of
/// temperature. Everything else in a scene is positive or zero.
[[nodiscard]] bool may_be_negative(const std::string& name);
[[nodiscard]] bool is_joint_damper(const std::string& name);
/// Scale of a quantity that starts at zero: 1 % of the scene's mass for masses, 1 % of the largest
/// tension for a load cell's zero, else 1.
[[nodiscard]] double scale_at_zero(const model::Scene& scene, const std::string& name);

/// Stiffness of the rotational spring NODE.rotational_AXIS that is half way between a free and a
/// held end, N m/rad: 3 EI/L of a beam without tension, sqrt(EI T) of a long cable, here their sum,
/// of the first member there. 0 for other parameters, and where members do not lie along one axis.
[[nodiscard]] double half_held(const model::Scene& scene, const std::string& name);

}  // namespace rigfit::ident
