#include "model/chain/assembly.h"

#include <cassert>

#include "model/chain/assembly_scatter.h"

namespace rigfit::model {
namespace {

template <class Sink>
void supports(const Chain& chain, const Numbering& numbering, const ChainState& state, Sink& sink) {
  Scatter<Sink> scatter(chain, numbering, sink);
  sink.member(-1);
  for (const NodeSupport& support : chain.supports) {
    const Vector3d u = state.position.col(support.node) - chain.drawn.col(support.node);
    const Vector3d force = support.translational.cwiseProduct(u);
    sink.add_energy(0.5 * u.dot(force));
    scatter.node_force(support.node, force);
    if constexpr (Sink::tangent) {
      scatter.nodes(support.node, support.node, support.translational.asDiagonal());
    }
    if (support.rotation < 0 || !(support.rotational.maxCoeff() > 0)) continue;
    const auto r = at(support.rotation);
    const Vector3d w =
        director_weights(support.rotational[1], support.rotational[2], support.rotational[0]);
    const Matrix3d ground = Matrix3d::Identity();
    sink.add_energy(joint_energy(ground, state.rotation[r], w));
    const RotationDerivatives d = joint_derivatives(ground, state.rotation[r], w);
    scatter.rotation_force(support.rotation, d.gradient_b);
    if constexpr (Sink::tangent) scatter.node_rotation(support.rotation, d.same);
  }
}

template <class Sink>
void evaluate(const Chain& chain, const Numbering& numbering, const ChainState& state,
              const VectorXd* axial_force, Sink& sink) {
  Scatter<Sink> scatter(chain, numbering, sink);
  for (std::size_t m = 0; m < chain.members.size(); ++m) {
    const ChainMember& member = chain.members[m];
    sink.member(static_cast<int>(m));
    for (int i = 0; i < member.segments; ++i) {
      const int index = member.first_segment + i;
      const Segment& s = chain.segments[at(index)];
      const Directed here = directed(chain, state, index);
      const Vector3d t = here.directors.col(0);
      const double stiffness = s.EA / s.length, stretch = here.length - s.length;
      const double force = stiffness * stretch;
      sink.add_energy(0.5 * force * stretch);
      scatter.edge_force(s, force * t);
      if constexpr (Sink::tangent) {
        const double geometric = (axial_force ? (*axial_force)[index] : force) / here.length;
        Matrix3d block = (stiffness - geometric) * t * t.transpose();
        block.diagonal().array() += geometric;
        scatter.edge(s, block);
      }
    }
    member_joints(chain, state, member, 1, scatter, sink);
  }
  supports(chain, numbering, state, sink);
}

/// Calls `f` with nodes and the masses that weigh on them.
template <class F>
void each_weight(const Chain& chain, const F& f) {
  for (const Segment& s : chain.segments) {
    f(s.a, s.mass / 2);
    f(s.b, s.mass / 2);
  }
  for (const PointMass& mass : chain.masses) {
    f(mass.node[0], mass.mass * (1 - mass.fraction));
    if (mass.fraction > 0) f(mass.node[1], mass.mass * mass.fraction);
  }
}

}  // namespace

Assembly::Assembly(const Chain& chain, Motion motion)
    : chain_(&chain), numbering_(number_unknowns(chain, motion)) {}

VectorXd Assembly::weight() const {
  VectorXd weight = VectorXd::Zero(size());
  ForceSink sink{{}, weight.data()};
  Scatter<ForceSink> scatter(*chain_, numbering_, sink);
  each_weight(*chain_,
              [&](int node, double mass) { scatter.node_force(node, mass * chain_->gravity); });
  return weight;
}

double Assembly::potential(const ChainState& state) const {
  EnergySink sink;
  evaluate(*chain_, numbering_, state, nullptr, sink);
  each_weight(*chain_, [&](int node, double mass) {
    sink.energy -= mass * chain_->gravity.dot(state.position.col(node));
  });
  return sink.energy;
}

void Assembly::force(const ChainState& state, VectorXd& force) const {
  assert(force.size() == size());
  force = -weight();
  ForceSink sink{{}, force.data()};
  evaluate(*chain_, numbering_, state, nullptr, sink);
}

void Assembly::force_and_tangent(const ChainState& state, VectorXd& force, EnvelopeMatrix& tangent,
                                 const VectorXd* axial_force) const {
  assert(force.size() == size() && tangent.size() == size());
  force = -weight();
  tangent.set_zero();
  MatrixSink sink{{}, force.data(), &tangent};
  evaluate(*chain_, numbering_, state, axial_force, sink);
}

MatrixXd Assembly::stiffness_energy(const ChainState& state, const MatrixXd& q) const {
  const QuadraticSink::Rows rows = q;
  QuadraticSink::Rows energy =
      QuadraticSink::Rows::Zero(static_cast<Index>(chain_->members.size()) + 1, q.cols());
  QuadraticSink sink{{}, &rows, &energy};
  evaluate(*chain_, numbering_, state, nullptr, sink);
  return energy;
}

void Assembly::mass(EnvelopeMatrix& mass) const {
  mass.set_zero();
  MatrixSink sink{{}, nullptr, &mass};
  Scatter<MatrixSink> scatter(*chain_, numbering_, sink);
  const auto block = [&](int p, int q, double value) {
    scatter.nodes(p, q, value * Matrix3d::Identity());
  };
  for (std::size_t k = 0; k < chain_->segments.size(); ++k) {
    const Segment& s = chain_->segments[k];
    block(s.a, s.a, (0.5 - s.coupling) * s.mass);
    block(s.b, s.b, (0.5 - s.coupling) * s.mass);
    block(s.a, s.b, s.coupling * s.mass);
    const int twist = numbering_.twist[static_cast<Index>(k)];
    if (twist >= 0 && s.polar > 0) mass.add(twist, twist, s.polar);
  }
  for (const PointMass& m : chain_->masses) {
    const double f = m.fraction;
    block(m.node[0], m.node[0], m.mass * (1 - f) * (1 - f));
    if (!(f > 0)) continue;
    block(m.node[1], m.node[1], m.mass * f * f);
    block(m.node[0], m.node[1], m.mass * f * (1 - f));
  }
}

void Assembly::damping(const ChainState& state, EnvelopeMatrix& damping) const {
  damping.set_zero();
  MatrixSink sink{{}, nullptr, &damping};
  Scatter<MatrixSink> scatter(*chain_, numbering_, sink);
  for (std::size_t k = 0; k < chain_->segments.size(); ++k) {
    const Segment& s = chain_->segments[k];
    if (!(s.axial_damping > 0)) continue;
    const Vector3d t = directed(*chain_, state, static_cast<int>(k)).directors.col(0);
    scatter.edge(s, s.axial_damping * t * t.transpose());
  }
  // Rates of bend and twist: the difference of both sides' angular velocities, normal to and along
  // the mean tangent.
  const auto dissipation = [](const JointSprings& k, const Vector3d& ta, const Vector3d& tb) {
    const Vector3d m = (ta + tb).normalized();
    return Matrix3d(k.bending_damping * (Matrix3d::Identity() - m * m.transpose()) +
                    k.torsion_damping * m * m.transpose());
  };
  for (const InnerJoint& joint : chain_->inner_joints) {
    if (!(joint.springs.bending_damping + joint.springs.torsion_damping > 0)) continue;
    const Directed a = directed(*chain_, state, joint.segment[0]);
    const Directed b = directed(*chain_, state, joint.segment[1]);
    const Matrix3d d = dissipation(joint.springs, a.directors.col(0), b.directors.col(0));
    const auto ja = segment_rotation(a), jb = segment_rotation(b);
    scatter.two_segments(joint, ja.transpose() * d * ja, -ja.transpose() * d * jb,
                         jb.transpose() * d * jb);
  }
  for (const EndJoint& joint : chain_->end_joints) {
    if (!(joint.springs.bending_damping + joint.springs.torsion_damping > 0)) continue;
    const Directed b = directed(*chain_, state, joint.segment);
    const Matrix3d d =
        dissipation(joint.springs, node_side(joint, state).col(0), b.directors.col(0));
    const auto j = segment_rotation(b);
    scatter.node_segment(joint.rotation, joint.segment, d, -d * j, j.transpose() * d * j);
  }
}

void Assembly::advance(const ChainState& state, const VectorXd& increment, double factor,
                       ChainState& out) const {
  const auto moved = [&](int node) -> Vector3d {
    return state.position.col(node) + factor * numbering_.displacement_in(increment, node);
  };
  if (&out != &state) {
    out.position.resize(3, chain_->nodes);
    out.director.resize(3, chain_->frames);
    out.rotation.resize(state.rotation.size());
  }
  for (std::size_t k = 0; chain_->frames > 0 && k < chain_->segments.size(); ++k) {
    const Segment& s = chain_->segments[k];
    if (s.frame < 0) continue;
    const Vector3d t = (state.position.col(s.b) - state.position.col(s.a)).normalized();
    const Vector3d after = (moved(s.b) - moved(s.a)).normalized();
    Vector3d d = state.director.col(s.frame);
    const int twist = numbering_.twist[static_cast<Index>(k)];
    if (twist >= 0) {
      const double angle = factor * increment[twist];
      d = std::cos(angle) * d + std::sin(angle) * t.cross(d);
    }
    d = transported(d, t, after);
    out.director.col(s.frame) = (d - after * after.dot(d)).normalized();
  }
  for (int node = 0; node < chain_->nodes; ++node) out.position.col(node) = moved(node);
  for (std::size_t r = 0; r < state.rotation.size(); ++r) {
    const Vector3d local = factor * numbering_.rotation_in(increment, static_cast<Index>(r));
    const Vector3d psi = chain_->rotation_basis[r] * local;
    const double angle = psi.norm();
    if (angle > 0) {
      out.rotation[r] =
          Eigen::AngleAxisd(angle, psi / angle).toRotationMatrix() * state.rotation[r];
    } else {
      out.rotation[r] = state.rotation[r];
    }
  }
}

Eigen::SparseMatrix<double, Eigen::RowMajor> Assembly::elongations(const ChainState& state) const {
  const auto segments = static_cast<Index>(chain_->segments.size());
  Eigen::SparseMatrix<double, Eigen::RowMajor> result(segments, size());
  result.reserve(VectorXi::Constant(segments, 6));
  for (Index k = 0; k < segments; ++k) {
    const Segment& s = chain_->segments[at(k)];
    const Vector3d t = (state.position.col(s.b) - state.position.col(s.a)).normalized();
    for (int axis = 0; axis < 3; ++axis) {
      const int a = numbering_.displacement(axis, s.a), b = numbering_.displacement(axis, s.b);
      if (a >= 0) result.insert(k, a) = -t[axis];
      if (b >= 0) result.insert(k, b) = t[axis];
    }
  }
  return result;
}

VectorXd Assembly::row_of(const ChainPoint& point, const Vector3d& direction) const {
  VectorXd row = VectorXd::Zero(size());
  ForceSink sink{{}, row.data()};
  Scatter<ForceSink> scatter(*chain_, numbering_, sink);
  for (std::size_t k = 0; k < at(point.count); ++k) {
    scatter.node_force(point.node[k], point.weight[k] * direction);
  }
  return row;
}

}  // namespace rigfit::model
