// Energy of a state, by member and kind.
#pragma once

#include <vector>

namespace rigfit::model {

/// J, per member; `nodes` holds the scene's nodes (supports' springs count as axial, point masses
/// and their gravity).
struct Energy {
  double axial = 0, bending = 0, torsion = 0, gravity = 0, kinetic = 0;
  /// All but the kinetic energy, J.
  [[nodiscard]] double potential() const { return axial + bending + torsion + gravity; }
  /// Potential and kinetic energy, J.
  [[nodiscard]] double total() const { return potential() + kinetic; }
  /// Adds kind by kind.
  Energy& operator+=(const Energy& other);
};
/// Energy of every member, in the scene's order, and of the nodes.
struct EnergyAccount {
  std::vector<Energy> members;
  Energy nodes;
  /// Of all members and nodes.
  [[nodiscard]] Energy sum() const;
};

}  // namespace rigfit::model
