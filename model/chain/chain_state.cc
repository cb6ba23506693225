// Where a chain is: its drawn state, directors, places (declared in chain.h).
#include <Eigen/Geometry>

#include "model/chain/chain.h"

namespace rigfit::model {

void settle(Chain& chain, const ChainState& state) {
  for (EndJoint& joint : chain.end_joints) {
    if (!joint.stress_free_at_equilibrium) continue;
    Eigen::Matrix3d directors;
    double length = 0;
    directors_of(chain, state, joint.segment, directors, length);
    if (joint.rotation >= 0) {
      directors = state.rotation[static_cast<std::size_t>(joint.rotation)].transpose() * directors;
    }
    joint.directors = directors;
  }
  chain.settled = true;
}

void directors_of(const Chain& chain, const ChainState& state, int segment,
                  Eigen::Matrix3d& directors, double& length) {
  const Segment& s = chain.segments[static_cast<std::size_t>(segment)];
  const Eigen::Vector3d e = state.position.col(s.b) - state.position.col(s.a);
  length = e.norm();
  directors.col(0) = e / length;
  if (s.frame >= 0) {
    directors.col(1) = state.director.col(s.frame);
    directors.col(2) = directors.col(0).cross(directors.col(1));
  } else {
    directors.rightCols<2>().setZero();
  }
}

ChainState drawn_state(const Chain& chain) {
  ChainState state;
  state.position = chain.drawn;
  state.director = chain.drawn_director;
  state.rotation.assign(chain.rotating_node.size(), Eigen::Matrix3d::Identity());
  return state;
}

Eigen::Vector3d position_of(const ChainPoint& point, const Eigen::Matrix3Xd& position) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = 0; k < point.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    sum += point.weight[i] * position.col(point.node[i]);
  }
  return sum;
}

}  // namespace rigfit::model
