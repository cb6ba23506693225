#include "model/chain/assembly.h"
#include "model/chain/joint_energy.h"

namespace rigfit::model {
namespace {

/// Bending and torsion of a joint: the latter is K3 (1 + cos phi)(1 - cos tau) / 2.
void add_joint(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b, const JointSprings& k,
               Energy& energy) {
  const Eigen::Vector3d w = director_weights(k.about_1, k.about_2, k.torsion);
  // 1 - a . b = |a - b|^2 / 2 of unit vectors, without cancellation.
  const Eigen::Vector3d d = 0.5 * (a - b).colwise().squaredNorm().transpose();
  const double torsion = k.torsion > 0 ? 0.5 * k.torsion * (d[1] + d[2] - d[0]) : 0;
  energy.torsion += torsion;
  energy.bending += w.dot(d) - torsion;
}

}  // namespace

Energy& Energy::operator+=(const Energy& other) {
  axial += other.axial;
  bending += other.bending;
  torsion += other.torsion;
  gravity += other.gravity;
  kinetic += other.kinetic;
  return *this;
}

Energy EnergyAccount::sum() const {
  Energy sum = nodes;
  for (const Energy& member : members) sum += member;
  return sum;
}

EnergyAccount Assembly::energy(const ChainState& state, const Eigen::VectorXd& velocity) const {
  const Chain& chain = *chain_;
  EnergyAccount account;
  account.members.resize(chain.members.size());
  const bool moving = velocity.size() == size();
  const auto speed = [&](int node) {
    Eigen::Vector3d v = Eigen::Vector3d::Zero();
    for (int axis = 0; moving && axis < 3; ++axis) {
      const int i = numbering_.displacement(axis, node);
      if (i >= 0) v[axis] = velocity[i];
    }
    return v;
  };
  for (std::size_t m = 0; m < chain.members.size(); ++m) {
    const ChainMember& member = chain.members[m];
    Energy& energy = account.members[m];
    Eigen::Matrix3d last;
    for (int i = 0; i < member.segments; ++i) {
      const int index = member.first_segment + i;
      const Segment& s = chain.segments[static_cast<std::size_t>(index)];
      Eigen::Matrix3d here;
      double length = 0;
      directors_of(chain, state, index, here, length);
      const double stretch = length - s.length;
      energy.axial += 0.5 * s.EA / s.length * stretch * stretch;
      energy.gravity -=
          0.5 * s.mass * chain.gravity.dot(state.position.col(s.a) + state.position.col(s.b));
      if (moving) {
        const Eigen::Vector3d va = speed(s.a), vb = speed(s.b);
        energy.kinetic +=
            s.mass * (0.5 * (0.5 - s.coupling) * (va.squaredNorm() + vb.squaredNorm()) +
                      s.coupling * va.dot(vb));
        const int twist = numbering_.twist[index];
        if (twist >= 0) energy.kinetic += 0.5 * s.polar * velocity[twist] * velocity[twist];
      }
      if (i > 0) {
        add_joint(last, here,
                  chain.inner_joints[static_cast<std::size_t>(member.first_joint + i - 1)].springs,
                  energy);
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
      add_joint(node, here, springs, energy);
    }
  }
  for (const PointMass& mass : chain.masses) {
    Energy& energy =
        mass.member < 0 ? account.nodes : account.members[static_cast<std::size_t>(mass.member)];
    const double f = mass.fraction;
    const Eigen::Vector3d x =
        (1 - f) * state.position.col(mass.node[0]) + f * state.position.col(mass.node[1]);
    energy.gravity -= mass.mass * chain.gravity.dot(x);
    if (moving) {
      const Eigen::Vector3d v = (1 - f) * speed(mass.node[0]) + f * speed(mass.node[1]);
      energy.kinetic += 0.5 * mass.mass * v.squaredNorm();
    }
  }
  for (const NodeSupport& support : chain.supports) {
    const Eigen::Vector3d u = state.position.col(support.node) - chain.drawn.col(support.node);
    account.nodes.axial += 0.5 * u.dot(support.translational * u);
    if (support.rotation >= 0) {
      const JointSprings springs{support.rotational[1], support.rotational[2],
                                 support.rotational[0], 0, 0};
      Energy turning;
      add_joint(Eigen::Matrix3d::Identity(),
                state.rotation[static_cast<std::size_t>(support.rotation)], springs, turning);
      account.nodes.bending += turning.bending + turning.torsion;
    }
  }
  return account;
}

}  // namespace rigfit::model
