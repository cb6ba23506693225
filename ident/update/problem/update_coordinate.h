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

  [[nodiscard]] double value(double q) const;
  [[nodiscard]] double derivative(double q) const;  ///< d value / d q
  [[nodiscard]] double coordinate(double value) const;
};

/// Whether a parameter may have any sign: coordinates of nodes, a load cell's zero, a change of
/// temperature. Everything else in a scene is positive or zero.
[[nodiscard]] bool may_be_negative(const std::string& name);
[[nodiscard]] bool is_joint_damper(const std::string& name);
/// Scale of a quantity that starts at zero: 1 % of the scene's mass for masses, 1 % of the largest
/// tension for a load cell's zero, else 1.
[[nodiscard]] double scale_at_zero(const model::Scene& scene, const std::string& name);

}  // namespace rigfit::ident
