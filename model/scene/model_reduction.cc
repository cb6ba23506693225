#include "model/scene/model_reduction.h"

#include <Eigen/Geometry>

#include "model/scene/actual_state.h"

namespace rigfit::model {
namespace {

constexpr double kParallel = 1e-12;  // difference of unit vectors that rounding of positions leaves

bool rigid_end(const Member& member, int end) {
  return member.joint[at(end)] == Member::Joint::rigid &&
         (member.EI[0] > 0 || member.EI[1] > 0 || member.GJ > 0);
}

/// True when mirroring at the plane normal to n maps the scene at rest onto itself.
bool symmetric_about(const Scene& scene, const Vector3d& n, bool coordinate_axis) {
  if (std::abs(scene.gravity.dot(n)) > kParallel * scene.gravity.norm()) return false;
  for (const Member& member : scene.members) {
    const Vector3d chord = chord_of(scene, member);
    if (std::abs(chord.dot(n)) > kParallel * chord.norm()) return false;
    if (member.EI[0] != member.EI[1]) {
      const double along = std::abs(material_axes(chord).col(1).dot(n));
      if (along > kParallel && along < 1 - kParallel) return false;
    }
  }
  if (!coordinate_axis) {
    for (const auto& node : scene.nodes) {
      if (node.support.kind == Support::Kind::elastic) return false;
    }
  }
  return true;
}

}  // namespace

std::vector<std::array<int, 2>> member_nodes(const Scene& scene) {
  std::vector<std::array<int, 2>> ends(scene.members.size());
  for (std::size_t m = 0; m < ends.size(); ++m) {
    for (std::size_t end = 0; end < 2; ++end) {
      ends[m][end] = index_named(scene, scene.nodes, scene.members[m].nodes[end]);
    }
  }
  return ends;
}

Matrix3d material_axes(const Vector3d& chord) {
  const Vector3d t = chord.normalized();
  Vector3d about_z = Vector3d::UnitZ() - t.z() * t;
  if (about_z.norm() < 1e-6) about_z = Vector3d::UnitX() - t.x() * t;
  about_z.normalize();
  Matrix3d axes;
  axes << t, about_z, t.cross(about_z);
  return axes;
}

ModelReduction reduce_model(const Scene& scene, std::optional<bool> torsion) {
  const auto ends = member_nodes(scene);
  ModelReduction reduction;
  std::vector<int> rigid(scene.nodes.size(), 0);
  for (std::size_t m = 0; m < ends.size(); ++m) {
    for (int end = 0; end < 2; ++end) {
      if (rigid_end(scene.members[m], end)) ++rigid[at(ends[m][at(end)])];
    }
  }
  reduction.attitude.resize(scene.nodes.size(), NodeAttitude::released);
  for (std::size_t k = 0; k < scene.nodes.size(); ++k) {
    const Support& support = scene.nodes[k].support;
    const bool elastic = support.kind == Support::Kind::elastic;
    const bool sprung = (support.rotational.array() > 0).any();
    if (support.kind == Support::Kind::clamped ||
        (elastic && support.rotational.array().isInf().all())) {
      reduction.attitude[k] = NodeAttitude::held;
    } else if (support.kind != Support::Kind::pinned &&
               (rigid[k] > 1 || (elastic && rigid[k] == 1 && sprung))) {
      reduction.attitude[k] = NodeAttitude::turning;
    }
  }

  reduction.torsion.resize(scene.members.size(), false);
  for (std::size_t m = 0; m < ends.size(); ++m) {
    const Member& member = scene.members[m];
    const bool unequal = member.EI[0] != member.EI[1];
    bool twist_held = false, torque_enters = false;
    for (std::size_t end = 0; end < 2; ++end) {
      if (member.joint[end] != Member::Joint::rigid) continue;
      const auto node = at(ends[m][end]);
      const NodeAttitude attitude = reduction.attitude[node];
      if (attitude != NodeAttitude::released ||
          scene.nodes[node].support.kind == Support::Kind::pinned) {
        twist_held = true;
      }
      if (attitude != NodeAttitude::turning) continue;
      if (scene.nodes[node].support.kind == Support::Kind::elastic) torque_enters = true;
      for (std::size_t other = 0; other < ends.size(); ++other) {
        if (other == m) continue;
        for (std::size_t e = 0; e < 2; ++e) {
          if (ends[other][e] != ends[m][end] || !rigid_end(scene.members[other], int(e))) continue;
          const double sine = chord_of(scene, member)
                                  .normalized()
                                  .cross(chord_of(scene, scene.members[other]).normalized())
                                  .norm();
          if (sine > 1e-9 || scene.members[other].EI[0] != scene.members[other].EI[1]) {
            torque_enters = true;
          }
        }
      }
    }
    const bool wanted = member.GJ > 0 && twist_held && (torque_enters || member.polar_inertia > 0);
    reduction.torsion[m] = unequal || (torsion ? *torsion && member.GJ > 0 && twist_held : wanted);
    if (!reduction.torsion[m] && wanted) reduction.torsion_left_out = true;
  }

  // The plane of symmetry: z first, then the other axes, then that of the first inclined member.
  for (const int k : {2, 0, 1}) {
    if (!symmetric_about(scene, Vector3d::Unit(k), true)) continue;
    reduction.planar = true;
    for (int row = 0; row < 3; ++row) {
      reduction.axes.row(row) = Vector3d::Unit((k + 1 + row) % 3).transpose();
    }
    return reduction;
  }
  for (const Member& member : scene.members) {
    const Vector3d chord = chord_of(scene, member);
    const Vector3d normal = chord.cross(-scene.gravity);
    if (normal.norm() < 1e-9 * chord.norm() * scene.gravity.norm()) continue;
    const Vector3d n = normal.normalized();
    if (!symmetric_about(scene, n, false)) break;
    reduction.planar = true;
    const Vector3d up = (-scene.gravity).normalized();
    reduction.axes << up.cross(n).transpose(), up.transpose(), n.transpose();
    break;
  }
  return reduction;
}

}  // namespace rigfit::model
