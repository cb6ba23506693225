// Where a chain is: its drawn state, directors, places; its numbers (declared in chain.h).
#include <Eigen/Geometry>

#include "model/algebra/numbers.h"
#include "model/chain/chain.h"

namespace rigfit::model {

std::vector<int> Chain::segment_counts() const {
  std::vector<int> counts;
  for (const ChainMember& member : members) counts.push_back(member.segments);
  return counts;
}

void settle(Chain& chain, const ChainState& state) {
  for (EndJoint& joint : chain.end_joints) {
    if (!joint.stress_free_at_equilibrium) continue;
    joint.directors = directed(chain, state, joint.segment).directors;
    if (joint.rotation >= 0) {
      const Matrix3d& turn = state.rotation[at(joint.rotation)];
      joint.directors = (turn.transpose() * joint.directors).eval();
    }
  }
  chain.settled = true;
}

Directed directed(const Chain& chain, const ChainState& state, int segment) {
  const Segment& s = chain.segments[at(segment)];
  const Vector3d e = state.position.col(s.b) - state.position.col(s.a);
  Directed out;
  out.length = e.norm();
  out.directors.col(0) = e / out.length;
  if (s.frame >= 0) {
    out.directors.col(1) = state.director.col(s.frame);
    out.directors.col(2) = out.directors.col(0).cross(out.directors.col(1));
  } else {
    out.directors.rightCols<2>().setZero();
  }
  return out;
}

VectorXd axial_forces(const Chain& chain, const ChainState& state) {
  VectorXd forces(static_cast<Index>(chain.segments.size()));
  for (Index k = 0; k < forces.size(); ++k) {
    const Segment& s = chain.segments[static_cast<std::size_t>(k)];
    const double length = (state.position.col(s.b) - state.position.col(s.a)).norm();
    forces[k] = s.EA * (length / s.length - 1);
  }
  return forces;
}

void carry_frames(const Chain& chain, const ChainState& from, ChainState& to) {
  for (const Segment& s : chain.segments) {
    if (s.frame < 0) continue;
    const Vector3d t = (from.position.col(s.b) - from.position.col(s.a)).normalized();
    const Vector3d after = (to.position.col(s.b) - to.position.col(s.a)).normalized();
    to.director.col(s.frame) = transported(from.director.col(s.frame), t, after);
  }
}

Vector3d transported(const Vector3d& d, const Vector3d& from, const Vector3d& to) {
  return d - d.dot(to) / (1 + from.dot(to)) * (from + to);
}

ChainState drawn_state(const Chain& chain) {
  ChainState state;
  state.position = chain.drawn;
  state.director = chain.drawn_director;
  state.rotation.assign(chain.rotating_node.size(), Matrix3d::Identity());
  return state;
}

Vector3d position_of(const ChainPoint& point, const Matrix3Xd& position) {
  Vector3d sum = Vector3d::Zero();
  for (int k = 0; k < point.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    sum += point.weight[i] * position.col(point.node[i]);
  }
  return sum;
}

}  // namespace rigfit::model
