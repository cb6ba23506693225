// Which unknowns a motion of a chain has, and their order.
#pragma once

#include "model/algebra/envelope_matrix.h"
#include "model/algebra/numbers.h"
#include "model/chain/chain.h"

namespace rigfit::model {

enum class Motion { in_plane, out_of_plane, space };

/// Unknowns by what they are; -1: not an unknown of this motion. Numbered along the chain so that
/// coupled unknowns have near numbers.
struct Numbering {
  Motion motion = Motion::space;
  int size = 0;
  Eigen::Matrix3Xi displacement;  ///< 3 x nodes
  VectorXi twist;                 ///< segments
  Eigen::Matrix3Xi rotation;      ///< 3 x rotating nodes
  std::shared_ptr<const Envelope> envelope;

  /// A node's part of increments q of the unknowns; zero where it has none.
  [[nodiscard]] Vector3d displacement_in(const Ref<const VectorXd>& q, int node) const {
    return part_of(q, displacement.col(node));
  }
  /// A rotating node's, in its own axes.
  [[nodiscard]] Vector3d rotation_in(const Ref<const VectorXd>& q, Index r) const {
    return part_of(q, rotation.col(r));
  }

 private:
  static Vector3d part_of(const Ref<const VectorXd>& q, const Eigen::Vector3i& unknowns) {
    Vector3d v = Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      if (unknowns[axis] >= 0) v[axis] = q[unknowns[axis]];
    }
    return v;
  }
};

/// Unknowns of a motion of a chain, numbered along it.
[[nodiscard]] Numbering number_unknowns(const Chain& chain, Motion motion);

}  // namespace rigfit::model
