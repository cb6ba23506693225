#include "model/chain/assembly.h"
#include "model/chain/joint_energy.h"

namespace rigfit::model {
namespace {

/// Bending and torsion of a joint; 1 - a . b = |a - b|^2 / 2 of unit vectors, without cancellation.
double joint_energy(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b, const JointSprings& k) {
  return 0.5 * director_weights(k.about_1, k.about_2, k.torsion)
                   .dot((a - b).colwise().squaredNorm().transpose());
}

}  // namespace

double Assembly::potential(const ChainState& state) const {
  const Chain& chain = *chain_;
  double sum = 0;
  for (const ChainMember& member : chain.members) {
    Eigen::Matrix3d last;
    for (int i = 0; i < member.segments; ++i) {
      const int index = member.first_segment + i;
      const Segment& s = chain.segments[static_cast<std::size_t>(index)];
      Eigen::Matrix3d here;
      double length = 0;
      directors_of(chain, state, index, here, length);
      const double stretch = length - s.length;
      sum += 0.5 * s.EA / s.length * stretch * stretch;
      sum -= 0.5 * s.mass * chain.gravity.dot(state.position.col(s.a) + state.position.col(s.b));
      if (i > 0) {
        sum += joint_energy(
            last, here,
            chain.inner_joints[static_cast<std::size_t>(member.first_joint + i - 1)].springs);
      }
      last = here;
    }
    for (const int e : member.end_joint) {
      if (e < 0) continue;
      const EndJoint& joint = chain.end_joints[static_cast<std::size_t>(e)];
      Eigen::Matrix3d here, node = joint.directors;
      double length = 0;
      directors_of(chain, state, joint.segment, here, length);
      if (joint.rotation >= 0) {
        node = state.rotation[static_cast<std::size_t>(joint.rotation)] * node;
      }
      JointSprings springs = joint.springs;
      if (joint.stress_free_at_equilibrium && !chain.settled) springs.about_1 = springs.about_2 = 0;
      if (chain.segments[static_cast<std::size_t>(joint.segment)].frame < 0) {
        node.rightCols<2>().setZero();
      }
      sum += joint_energy(node, here, springs);
    }
  }
  for (const PointMass& mass : chain.masses) {
    const double f = mass.fraction;
    sum -= mass.mass * chain.gravity.dot((1 - f) * state.position.col(mass.node[0]) +
                                         f * state.position.col(mass.node[1]));
  }
  for (const NodeSupport& support : chain.supports) {
    const Eigen::Vector3d u = state.position.col(support.node) - chain.drawn.col(support.node);
    sum += 0.5 * u.dot(support.translational * u);
    if (support.rotation >= 0) {
      sum += joint_energy(
          Eigen::Matrix3d::Identity(), state.rotation[static_cast<std::size_t>(support.rotation)],
          {support.rotational[1], support.rotational[2], support.rotational[0], 0, 0});
    }
  }
  return sum;
}

}  // namespace rigfit::model
