#include "model/chain/assembly.h"

#include <cassert>
#include <cmath>

#include "model/chain/assembly_scatter.h"

namespace rigfit::model {
namespace {

template <class Sink>
void supports(const Chain& chain, const Numbering& numbering, const ChainState& state, Sink& sink) {
  Scatter<Sink> scatter(chain, numbering, sink);
  sink.member(-1);
  for (const NodeSupport& support : chain.supports) {
    scatter.template node_force<3>(
        support.node,
        support.translational * (state.position.col(support.node) - chain.drawn.col(support.node)));
    if constexpr (Sink::tangent) {
      scatter.template nodes<3>(support.node, support.node, support.translational);
    }
    if (support.rotation < 0 || !(support.rotational.maxCoeff() > 0)) continue;
    const auto r = static_cast<std::size_t>(support.rotation);
    const RotationDerivatives d = joint_derivatives(
        Eigen::Matrix3d::Identity(), state.rotation[r],
        director_weights(support.rotational[1], support.rotational[2], support.rotational[0]));
    scatter.rotation_force(support.rotation, d.gradient_b);
    if constexpr (Sink::tangent) {
      const Eigen::Matrix3d local =
          chain.rotation_basis[r].transpose() * d.same * chain.rotation_basis[r];
      for (int i = 0; i < 3; ++i) {
        for (int j = i; j < 3; ++j) {
          scatter.pair(numbering.rotation(i, support.rotation),
                       numbering.rotation(j, support.rotation), local(i, j));
        }
      }
    }
  }
}

/// Elastic derivatives in the plane: two displacements a node, an angle a turning node.
template <class Sink>
void evaluate_plane(const Chain& chain, const Numbering& numbering, const ChainState& state,
                    const Eigen::VectorXd* axial_force, Sink& sink) {
  Scatter<Sink> scatter(chain, numbering, sink);
  struct Edge {
    Vector2 t, n;
    double inverse_length;
  };
  const auto edge_of = [&](const Segment& s) {
    Edge edge;
    const Vector2 e = state.position.col(s.b).head<2>() - state.position.col(s.a).head<2>();
    edge.inverse_length = 1 / std::sqrt(e.squaredNorm());
    edge.t = e * edge.inverse_length;
    edge.n << -edge.t.y(), edge.t.x();
    return edge;
  };
  for (const ChainMember& member : chain.members) {
    sink.member(member.scene_member);
    Edge last;
    for (int i = 0; i < member.segments; ++i) {
      const int index = member.first_segment + i;
      const Segment& s = chain.segments[static_cast<std::size_t>(index)];
      const Edge edge = edge_of(s);
      const double stiffness = s.EA / s.length;
      const double force = stiffness * (1 / edge.inverse_length - s.length);
      scatter.template edge_force<2>(s, force * edge.t);
      if constexpr (Sink::tangent) {
        const double geometric =
            (axial_force ? (*axial_force)[index] : force) * edge.inverse_length;
        const Matrix2 block =
            stiffness * edge.t * edge.t.transpose() + geometric * edge.n * edge.n.transpose();
        scatter.template edge<2>(s, block);
      }
      if (i > 0) {
        const InnerJoint& joint =
            chain.inner_joints[static_cast<std::size_t>(member.first_joint + i - 1)];
        const double k = in_plane_stiffness(s, state, joint.springs);
        if (k > 0) {
          const Segment& r = chain.segments[static_cast<std::size_t>(index - 1)];
          const double kc = k * last.t.dot(edge.t);
          const double ks = k * (last.t.x() * edge.t.y() - last.t.y() * edge.t.x());
          const Vector2 na = last.n * last.inverse_length, nb = edge.n * edge.inverse_length;
          scatter.template edge_force<2>(r, -ks * na);
          scatter.template edge_force<2>(s, ks * nb);
          if constexpr (Sink::tangent) {
            const Vector2 ta = last.t * last.inverse_length, tb = edge.t * edge.inverse_length;
            const Matrix2 sa = na * ta.transpose(), sb = nb * tb.transpose();
            const Matrix2 aa = kc * na * na.transpose() + ks * (sa + sa.transpose());
            const Matrix2 bb = kc * nb * nb.transpose() - ks * (sb + sb.transpose());
            const Matrix2 ab = -kc * na * nb.transpose();
            scatter.template two_edges<2>(r, s, aa, ab, bb);
          }
        }
      }
      last = edge;
    }
    for (const int index : member.end_joint) {
      if (index < 0) continue;
      const EndJoint& joint = chain.end_joints[static_cast<std::size_t>(index)];
      const Segment& s = chain.segments[static_cast<std::size_t>(joint.segment)];
      const double k = in_plane_stiffness(s, state, acting(chain, joint));
      if (!(k > 0)) continue;
      const Edge edge = edge_of(s);
      Vector2 a = joint.directors.col(0).head<2>();
      if (joint.rotation >= 0) {
        a = state.rotation[static_cast<std::size_t>(joint.rotation)].topLeftCorner<2, 2>() * a;
      }
      const double kc = k * a.dot(edge.t);
      const double ks = k * (a.x() * edge.t.y() - a.y() * edge.t.x());
      const Vector2 n = edge.n * edge.inverse_length;
      const int turn = joint.rotation >= 0 ? numbering.rotation(2, joint.rotation) : -1;
      scatter.template edge_force<2>(s, ks * n);
      scatter.single_force(turn, -ks);
      if constexpr (Sink::tangent) {
        const Vector2 t = edge.t * edge.inverse_length;
        const Matrix2 st = n * t.transpose();
        scatter.template edge<2>(s, kc * n * n.transpose() - ks * (st + st.transpose()));
        scatter.template node_single<2>(s.b, turn, -kc * n);
        scatter.template node_single<2>(s.a, turn, kc * n);
        scatter.pair(turn, turn, kc);
      }
    }
  }
  supports(chain, numbering, state, sink);
}

template <class Sink>
void end_joint_in_space(const Chain& chain, const EndJoint& joint, const ChainState& state,
                        Scatter<Sink>& scatter, const Numbering& numbering) {
  const JointSprings springs = acting(chain, joint);
  if (!(springs.about_1 + springs.about_2 + springs.torsion > 0)) return;
  const Directed b = directed(chain, state, joint.segment);
  const Segment& s = chain.segments[static_cast<std::size_t>(joint.segment)];
  const Eigen::Vector3d t = b.directors.col(0);
  const RotationDerivatives d =
      joint_derivatives(node_side(joint, state), b.directors,
                        director_weights(springs.about_1, springs.about_2, springs.torsion));
  const Eigen::Matrix<double, 3, 4> j = segment_rotation(t, b.length);
  const Vector4 g = j.transpose() * d.gradient_b;
  scatter.template edge_force<3>(s, g.head<3>());
  scatter.single_force(numbering.twist[joint.segment], g[3]);
  scatter.rotation_force(joint.rotation, -d.gradient_b);
  if constexpr (Sink::tangent) {
    Matrix4 ss = j.transpose() * d.same * j;
    add_second_order(d.gradient_b, t, b.length, ss);
    scatter.node_segment(joint.rotation, joint.segment, d.same, d.cross * j, ss);
  }
}

template <class Sink>
void evaluate_space(const Chain& chain, const Numbering& numbering, const ChainState& state,
                    const Eigen::VectorXd* axial_force, Sink& sink) {
  Scatter<Sink> scatter(chain, numbering, sink);
  for (const ChainMember& member : chain.members) {
    sink.member(member.scene_member);
    Directed last;
    for (int i = 0; i < member.segments; ++i) {
      const int index = member.first_segment + i;
      const Segment& s = chain.segments[static_cast<std::size_t>(index)];
      const Directed here = directed(chain, state, index);
      const Eigen::Vector3d t = here.directors.col(0);
      const double stiffness = s.EA / s.length;
      const double force = stiffness * (here.length - s.length);
      scatter.template edge_force<3>(s, force * t);
      if constexpr (Sink::tangent) {
        const double geometric = (axial_force ? (*axial_force)[index] : force) / here.length;
        Eigen::Matrix3d block = (stiffness - geometric) * t * t.transpose();
        block.diagonal().array() += geometric;
        scatter.template edge<3>(s, block);
      }
      if (i > 0) {
        const InnerJoint& joint =
            chain.inner_joints[static_cast<std::size_t>(member.first_joint + i - 1)];
        const JointSprings& k = joint.springs;
        if (s.frame < 0 && k.about_1 > 0) {
          // Equal stiffnesses, no torsion: W = K (1 - ta . tb).
          const Segment& r = chain.segments[static_cast<std::size_t>(index - 1)];
          const Eigen::Vector3d ta = last.directors.col(0);
          const double c = ta.dot(t), fa = 1 / last.length, fb = 1 / here.length;
          const Eigen::Vector3d ua = t - c * ta, ub = ta - c * t;
          scatter.template edge_force<3>(r, -k.about_1 * fa * ua);
          scatter.template edge_force<3>(s, -k.about_1 * fb * ub);
          if constexpr (Sink::tangent) {
            const Eigen::Matrix3d pa = Eigen::Matrix3d::Identity() - ta * ta.transpose();
            const Eigen::Matrix3d pb = Eigen::Matrix3d::Identity() - t * t.transpose();
            const Eigen::Matrix3d xa = ua * ta.transpose(), xb = ub * t.transpose();
            const Eigen::Matrix3d aa = k.about_1 * fa * fa * (c * pa + xa + xa.transpose());
            const Eigen::Matrix3d bb = k.about_1 * fb * fb * (c * pb + xb + xb.transpose());
            const Eigen::Matrix3d ab = -k.about_1 * fa * fb * (pa * pb);
            scatter.template two_edges<3>(r, s, aa, ab, bb);
          }
        } else if (s.frame >= 0) {
          const RotationDerivatives d = joint_derivatives(
              last.directors, here.directors, director_weights(k.about_1, k.about_2, k.torsion));
          const Eigen::Vector3d ta = last.directors.col(0);
          const Eigen::Matrix<double, 3, 4> ja = segment_rotation(ta, last.length);
          const Eigen::Matrix<double, 3, 4> jb = segment_rotation(t, here.length);
          const Vector4 ga = -ja.transpose() * d.gradient_b, gb = jb.transpose() * d.gradient_b;
          scatter.template edge_force<3>(chain.segments[static_cast<std::size_t>(index - 1)],
                                         ga.head<3>());
          scatter.template edge_force<3>(s, gb.head<3>());
          scatter.single_force(numbering.twist[index - 1], ga[3]);
          scatter.single_force(numbering.twist[index], gb[3]);
          if constexpr (Sink::tangent) {
            Matrix4 aa = ja.transpose() * d.same * ja, bb = jb.transpose() * d.same * jb;
            add_second_order(-d.gradient_b, ta, last.length, aa);
            add_second_order(d.gradient_b, t, here.length, bb);
            scatter.two_segments(joint, aa, ja.transpose() * d.cross * jb, bb);
          }
        }
      }
      last = here;
    }
    for (const int index : member.end_joint) {
      if (index < 0) continue;
      end_joint_in_space(chain, chain.end_joints[static_cast<std::size_t>(index)], state, scatter,
                         numbering);
    }
  }
  supports(chain, numbering, state, sink);
}

template <class Sink>
void evaluate(const Chain& chain, const Numbering& numbering, const ChainState& state,
              const Eigen::VectorXd* axial_force, Sink& sink) {
  if (numbering.motion == Motion::in_plane) {
    evaluate_plane(chain, numbering, state, axial_force, sink);
  } else {
    evaluate_space(chain, numbering, state, axial_force, sink);
  }
}

void add_gravity(const Chain& chain, const Numbering& numbering, Eigen::VectorXd& force) {
  const auto add = [&](int node, double mass) {
    for (int axis = 0; axis < 3; ++axis) {
      const int row = numbering.displacement(axis, node);
      if (row >= 0) force[row] -= mass * chain.gravity[axis];
    }
  };
  for (const Segment& s : chain.segments) {
    add(s.a, s.mass / 2);
    add(s.b, s.mass / 2);
  }
  for (const PointMass& mass : chain.masses) {
    add(mass.node[0], mass.mass * (1 - mass.fraction));
    if (mass.fraction > 0) add(mass.node[1], mass.mass * mass.fraction);
  }
}

}  // namespace

Assembly::Assembly(const Chain& chain, Motion motion, const Numbering* like)
    : chain_(&chain), numbering_(number_unknowns(chain, motion, like)) {}

void Assembly::force(const ChainState& state, Eigen::VectorXd& force) const {
  assert(force.size() == size());
  force.setZero();
  ForceSink sink{&force};
  evaluate(*chain_, numbering_, state, nullptr, sink);
  add_gravity(*chain_, numbering_, force);
}

void Assembly::force_and_tangent(const ChainState& state, Eigen::VectorXd& force,
                                 EnvelopeMatrix& tangent,
                                 const Eigen::VectorXd* axial_force) const {
  assert(force.size() == size() && tangent.size() == size());
  force.setZero();
  tangent.set_zero();
  MatrixSink sink{&force, &tangent};
  evaluate(*chain_, numbering_, state, axial_force, sink);
  add_gravity(*chain_, numbering_, force);
}

Eigen::MatrixXd Assembly::stiffness_energy(const ChainState& state,
                                           const Eigen::MatrixXd& q) const {
  Eigen::MatrixXd energy =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(chain_->members.size()) + 1, q.cols());
  QuadraticSink sink{&q, &energy, 0};
  evaluate(*chain_, numbering_, state, nullptr, sink);
  return energy;
}

void Assembly::mass(EnvelopeMatrix& mass) const {
  mass.set_zero();
  const auto block = [&](int p, int q, double value) {
    for (int axis = 0; axis < 3; ++axis) {
      const int row = numbering_.displacement(axis, p), col = numbering_.displacement(axis, q);
      if (row >= 0 && col >= 0) mass.add(row, col, value);
    }
  };
  for (std::size_t k = 0; k < chain_->segments.size(); ++k) {
    const Segment& s = chain_->segments[k];
    block(s.a, s.a, (0.5 - s.coupling) * s.mass);
    block(s.b, s.b, (0.5 - s.coupling) * s.mass);
    block(s.a, s.b, s.coupling * s.mass);
    const int twist = numbering_.twist[static_cast<Eigen::Index>(k)];
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
  MatrixSink sink{nullptr, &damping};
  Scatter<MatrixSink> scatter(*chain_, numbering_, sink);
  for (std::size_t k = 0; k < chain_->segments.size(); ++k) {
    const Segment& s = chain_->segments[k];
    if (!(s.axial_damping > 0)) continue;
    const Eigen::Vector3d t = directed(*chain_, state, static_cast<int>(k)).directors.col(0);
    scatter.edge<3>(s, s.axial_damping * t * t.transpose());
  }
  // Rates of bend and twist: the difference of both sides' angular velocities, normal to and along
  // the mean tangent.
  const auto dissipation = [](const JointSprings& k, const Eigen::Vector3d& ta,
                              const Eigen::Vector3d& tb) {
    const Eigen::Vector3d m = (ta + tb).normalized();
    return Eigen::Matrix3d(k.bending_damping * (Eigen::Matrix3d::Identity() - m * m.transpose()) +
                           k.torsion_damping * m * m.transpose());
  };
  for (const InnerJoint& joint : chain_->inner_joints) {
    if (!(joint.springs.bending_damping + joint.springs.torsion_damping > 0)) continue;
    const Directed a = directed(*chain_, state, joint.segment[0]);
    const Directed b = directed(*chain_, state, joint.segment[1]);
    const Eigen::Matrix3d d = dissipation(joint.springs, a.directors.col(0), b.directors.col(0));
    const auto ja = segment_rotation(a.directors.col(0), a.length);
    const auto jb = segment_rotation(b.directors.col(0), b.length);
    scatter.two_segments(joint, ja.transpose() * d * ja, -ja.transpose() * d * jb,
                         jb.transpose() * d * jb);
  }
  for (const EndJoint& joint : chain_->end_joints) {
    if (!(joint.springs.bending_damping + joint.springs.torsion_damping > 0)) continue;
    const Directed b = directed(*chain_, state, joint.segment);
    const Eigen::Vector3d t = b.directors.col(0);
    const Eigen::Matrix3d d = dissipation(joint.springs, node_side(joint, state).col(0), t);
    const auto j = segment_rotation(t, b.length);
    scatter.node_segment(joint.rotation, joint.segment, d, -d * j, j.transpose() * d * j);
  }
}

void Assembly::advance(const ChainState& state, const Eigen::VectorXd& increment, double factor,
                       ChainState& out) const {
  const auto moved = [&](int node) {
    Eigen::Vector3d x = state.position.col(node);
    for (int axis = 0; axis < 3; ++axis) {
      const int i = numbering_.displacement(axis, node);
      if (i >= 0) x[axis] += factor * increment[i];
    }
    return x;
  };
  if (&out != &state) {
    out.position.resize(3, chain_->nodes);
    out.director.resize(3, chain_->frames);
    out.rotation.resize(state.rotation.size());
  }
  for (std::size_t k = 0; chain_->frames > 0 && k < chain_->segments.size(); ++k) {
    const Segment& s = chain_->segments[k];
    if (s.frame < 0) continue;
    const Eigen::Vector3d t = (state.position.col(s.b) - state.position.col(s.a)).normalized();
    const Eigen::Vector3d after = (moved(s.b) - moved(s.a)).normalized();
    Eigen::Vector3d d = state.director.col(s.frame);
    const int twist = numbering_.twist[static_cast<Eigen::Index>(k)];
    if (twist >= 0) {
      const double angle = factor * increment[twist];
      d = std::cos(angle) * d + std::sin(angle) * t.cross(d);
    }
    d -= d.dot(after) / (1 + t.dot(after)) * (t + after);
    out.director.col(s.frame) = (d - after * after.dot(d)).normalized();
  }
  for (int node = 0; node < chain_->nodes; ++node) out.position.col(node) = moved(node);
  for (std::size_t r = 0; r < state.rotation.size(); ++r) {
    Eigen::Vector3d local = Eigen::Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const int i = numbering_.rotation(axis, static_cast<Eigen::Index>(r));
      if (i >= 0) local[axis] = factor * increment[i];
    }
    const Eigen::Vector3d psi = chain_->rotation_basis[r] * local;
    const double angle = psi.norm();
    if (angle > 0) {
      out.rotation[r] =
          Eigen::AngleAxisd(angle, psi / angle).toRotationMatrix() * state.rotation[r];
    } else {
      out.rotation[r] = state.rotation[r];
    }
  }
}

void Assembly::axial_forces(const ChainState& state, Eigen::VectorXd& forces) const {
  forces.resize(static_cast<Eigen::Index>(chain_->segments.size()));
  for (std::size_t k = 0; k < chain_->segments.size(); ++k) {
    const Segment& s = chain_->segments[k];
    const double length = (state.position.col(s.b) - state.position.col(s.a)).norm();
    forces[static_cast<Eigen::Index>(k)] = s.EA * (length / s.length - 1);
  }
}

Eigen::VectorXd Assembly::row_of(const ChainPoint& point, const Eigen::Vector3d& direction) const {
  Eigen::VectorXd row = Eigen::VectorXd::Zero(size());
  for (int i = 0; i < point.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (int axis = 0; axis < 3; ++axis) {
      const int unknown = numbering_.displacement(axis, point.node[k]);
      if (unknown >= 0) row[unknown] += point.weight[k] * direction[axis];
    }
  }
  return row;
}

}  // namespace rigfit::model
