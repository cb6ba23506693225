// Model reduction: the degrees of freedom that a scene keeps, and what can be left out without
// loss: the plane of symmetry, torsion.
//
// Torsion is kept in a member with GJ > 0 where torque can enter: its bending stiffnesses differ,
// it has polar inertia (torsional modes), or an end is rigidly joined to a node that turns with
// something that does not lie along it. Elsewhere a straight segment chain with equal bending
// stiffnesses bends without torque and its twist decouples exactly.
#pragma once

#include "model/algebra/numbers.h"
#include "model/scene/scene.h"

namespace rigfit::model {

/// Per scene node: what happens to rotation there.
enum class NodeAttitude {
  released,  ///< no moment passes
  held,      ///< clamped
  turning    ///< a rotation of its own, common to the members rigidly joined there
};

/// Degrees of freedom kept.
struct ModelReduction {
  std::vector<NodeAttitude> attitude;  ///< by node
  std::vector<bool> torsion;           ///< by member
  bool torsion_left_out = false;       ///< some member has GJ or polar inertia that is not modelled
  /// Chain axes in scene axes (rows): the third is the normal of the plane of symmetry if `planar`.
  Matrix3d axes = Matrix3d::Identity();
  bool planar = false;
};

/// Index of a scene's node or member by its name. Throws SceneError when there is none.
template <class Thing>
[[nodiscard]] int index_named(const Scene& scene, const std::vector<Thing>& things,
                              const std::string& name) {
  const auto found = std::ranges::find(things, name, &Thing::name);
  if (found == things.end()) {
    throw SceneError({scene.file, 0, 0, name}, "there is no node or member \"" + name + "\"",
                     "name one that the scene has");
  }
  return static_cast<int>(found - things.begin());
}
/// Index of each member's two nodes.
[[nodiscard]] std::vector<std::array<int, 2>> member_nodes(const Scene& scene);
[[nodiscard]] ModelReduction reduce_model(const Scene& scene,
                                          std::optional<bool> torsion = std::nullopt);

/// Material axes of a straight member: columns tangent, "about z" (z made normal to the tangent; x
/// for a member along z), and their product ("about the horizontal in-plane axis"). Scene axes.
[[nodiscard]] Matrix3d material_axes(const Vector3d& chord);

}  // namespace rigfit::model
