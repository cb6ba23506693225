#include "model/response/linear_energy.h"

#include "model/chain/index.h"
#include "model/chain/joint_energy.h"

namespace rigfit::model {
LinearEnergy::LinearEnergy(const Assembly& assembly, const ChainState& rest) : assembly_(assembly) {
  const Chain& chain = assembly.chain();
  for (std::size_t k = 0; k < chain.segments.size(); ++k) {
    const Segment& s = chain.segments[k];
    Eigen::Matrix3d here;
    double length = 0;
    directors_of(chain, rest, static_cast<int>(k), here, length);
    const Eigen::Vector3d t = here.col(0);
    const double force = s.EA * (length / s.length - 1);
    const Eigen::Matrix3d along = t * t.transpose();
    axial_.push_back({force * t, s.EA / s.length * along +
                                     force / length * (Eigen::Matrix3d::Identity() - along)});
  }
  for (std::size_t m = 0; m < chain.members.size(); ++m) {
    const ChainMember& member = chain.members[m];
    Eigen::Matrix3d a, b;
    double length_a = 0, length_b = 0;
    for (int i = 1; i < member.segments; ++i) {
      Joint joint;
      joint.member = m;
      joint.a = member.first_segment + i - 1;
      joint.b = member.first_segment + i;
      directors_of(chain, rest, joint.a, a, length_a);
      directors_of(chain, rest, joint.b, b, length_b);
      add_joint(joint, a, b, chain.inner_joints[at(member.first_joint + i - 1)].springs, length_a,
                length_b);
    }
    for (const int e : member.end_joint) {
      if (e < 0) continue;
      const EndJoint& end = chain.end_joints[at(e)];
      Joint joint;
      joint.member = m;
      joint.b = end.segment;
      joint.rotation = end.rotation;
      directors_of(chain, rest, end.segment, b, length_b);
      a = end.directors;
      if (end.rotation >= 0) a = rest.rotation[at(end.rotation)] * a;
      add_joint(joint, a, b, end.springs, 0, length_b);
    }
  }
  for (const NodeSupport& support : chain.supports) {
    const Eigen::Vector3d away = rest.position.col(support.node) - chain.drawn.col(support.node);
    springs_.push_back({support.node, support.translational * away, support.translational});
    if (support.rotation < 0) continue;
    const Eigen::Matrix3d& basis = chain.rotation_basis[at(support.rotation)];
    const RotationDerivatives d = joint_derivatives(
        Eigen::Matrix3d::Identity(), rest.rotation[at(support.rotation)],
        director_weights(support.rotational[1], support.rotational[2], support.rotational[0]));
    turns_.push_back(
        {support.rotation, basis.transpose() * d.gradient_b, basis.transpose() * d.same * basis});
  }
}

void LinearEnergy::add_joint(Joint joint, const Eigen::Matrix3d& a, const Eigen::Matrix3d& b,
                             const JointSprings& k, double length_a, double length_b) {
  for (const bool torsion : {false, true}) {
    if (torsion && !(k.torsion > 0)) continue;
    joint.torsion = torsion;
    const RotationDerivatives d = joint_derivatives(
        a, b,
        torsion ? director_weights(0, 0, k.torsion) : director_weights(k.about_1, k.about_2, 0));
    const auto jb = segment_rotation(b.col(0), length_b);
    joint.gradient_b = jb.transpose() * d.gradient_b;
    joint.bb = jb.transpose() * d.same * jb;
    add_second_order(d.gradient_b, b.col(0), length_b, joint.bb);
    joint.gradient_a.setZero();
    joint.aa.setZero();
    joint.ab.setZero();
    if (joint.a >= 0) {
      const auto ja = segment_rotation(a.col(0), length_a);
      joint.gradient_a = -ja.transpose() * d.gradient_b;
      joint.aa = ja.transpose() * d.same * ja;
      add_second_order(-d.gradient_b, a.col(0), length_a, joint.aa);
      joint.ab = ja.transpose() * d.cross * jb;
    } else if (joint.rotation >= 0) {
      const Eigen::Matrix3d& basis = assembly_.chain().rotation_basis[at(joint.rotation)];
      joint.gradient_a.head<3>() = -basis.transpose() * d.gradient_b;
      joint.aa.topLeftCorner<3, 3>() = basis.transpose() * d.same * basis;
      joint.ab.topRows<3>() = basis.transpose() * d.cross * jb;
    }
    joints_.push_back(joint);
  }
}

void LinearEnergy::add(const Eigen::VectorXd& u, const Eigen::VectorXd& v,
                       EnergyAccount& account) const {
  const Chain& chain = assembly_.chain();
  const Numbering& numbering = assembly_.numbering();
  const auto node = [&](const Eigen::VectorXd& x, int index) {
    Eigen::Vector3d out = Eigen::Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const int k = numbering.displacement(axis, index);
      if (k >= 0) out[axis] = x[k];
    }
    return out;
  };
  const auto value = [](const Eigen::VectorXd& x, int k) { return k >= 0 ? x[k] : 0.0; };
  const auto turn = [&](int rotation) {
    Vector4 out = Vector4::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      out[axis] = value(u, numbering.rotation(axis, rotation));
    }
    return out;
  };
  std::vector<Vector4> edge(chain.segments.size());
  for (std::size_t k = 0; k < chain.segments.size(); ++k) {
    const Segment& s = chain.segments[k];
    const Eigen::Vector3d ua = node(u, s.a), ub = node(u, s.b), va = node(v, s.a),
                          vb = node(v, s.b);
    const auto twist = numbering.twist[static_cast<Eigen::Index>(k)];
    edge[k] << ub - ua, value(u, twist);
    Energy& energy = account.members[at(s.member)];
    const Eigen::Vector3d de = edge[k].head<3>();
    energy.axial += axial_[k].gradient.dot(de) + 0.5 * de.dot(axial_[k].hessian * de);
    energy.gravity -= 0.5 * s.mass * chain.gravity.dot(ua + ub);
    const double spin = value(v, twist);
    energy.kinetic += s.mass * (0.5 * (0.5 - s.coupling) * (va.squaredNorm() + vb.squaredNorm()) +
                                s.coupling * va.dot(vb)) +
                      0.5 * s.polar * spin * spin;
  }
  for (const Joint& joint : joints_) {
    Vector4 a = Vector4::Zero();
    if (joint.a >= 0) {
      a = edge[at(joint.a)];
    } else if (joint.rotation >= 0) {
      a = turn(joint.rotation);
    }
    const Vector4& b = edge[at(joint.b)];
    Energy& energy = account.members[joint.member];
    (joint.torsion ? energy.torsion : energy.bending) +=
        joint.gradient_a.dot(a) + joint.gradient_b.dot(b) + 0.5 * a.dot(joint.aa * a) +
        a.dot(joint.ab * b) + 0.5 * b.dot(joint.bb * b);
  }
  for (const PointMass& mass : chain.masses) {
    Energy& energy = mass.member < 0 ? account.nodes : account.members[at(mass.member)];
    const auto mean = [&](const Eigen::VectorXd& x) -> Eigen::Vector3d {
      return (1 - mass.fraction) * node(x, mass.node[0]) + mass.fraction * node(x, mass.node[1]);
    };
    energy.gravity -= mass.mass * chain.gravity.dot(mean(u));
    energy.kinetic += 0.5 * mass.mass * mean(v).squaredNorm();
  }
  for (const Spring& spring : springs_) {
    const Eigen::Vector3d du = node(u, spring.node);
    account.nodes.axial += spring.gradient.dot(du) + 0.5 * du.dot(spring.hessian * du);
  }
  for (const Turn& spring : turns_) {
    const Eigen::Vector3d d = turn(spring.rotation).head<3>();
    account.nodes.bending += spring.gradient.dot(d) + 0.5 * d.dot(spring.hessian * d);
  }
}

}  // namespace rigfit::model
