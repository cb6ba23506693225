// Force of a load over time: a half-sine pulse, samples joined by straight lines, or none.
#pragma once

#include "model/algebra/numbers.h"
#include "model/scene/scene.h"

namespace rigfit::model {

/// Sampled force; zero outside its samples, linear between them.
struct ForceHistory {
  std::vector<double> time_s;  ///< strictly rising
  std::vector<double> force_N;
};

/// The force of a load of a scene as a function of time; a release has none after t = 0.
struct LoadForce {
  Load load;
  const ForceHistory* record = nullptr;  ///< what a load of kind `record` follows, not empty

  /// Force along the load's direction, N.
  [[nodiscard]] double at(double time_s) const;
  /// Times where the force or its slope jumps (a pulse's ends, a record's samples), rising.
  [[nodiscard]] std::vector<double> corners() const;
  /// The last time at which the force is not zero; 0 when it always is.
  [[nodiscard]] double end_s() const;
};
/// The last time at which any of the forces is not zero, s.
[[nodiscard]] double last_force_s(const std::vector<LoadForce>& forces);

}  // namespace rigfit::model
