#include "model/assembly.h"

#include <cassert>
#include <cmath>

#include "model/joint_energy.h"

namespace rigfit::model {
namespace {

using Vector2 = Eigen::Vector2d;
using Matrix2 = Eigen::Matrix2d;
using Matrix4 = Eigen::Matrix4d;
using Vector4 = Eigen::Vector4d;

/// Where derivatives go: to a force vector and an envelope matrix.
struct MatrixSink {
  static constexpr bool tangent = true;
  Eigen::VectorXd* force = nullptr;
  EnvelopeMatrix* matrix = nullptr;
  void member(int) {}
  void add_force(int i, double value) {
    if (force) (*force)[i] += value;
  }
  void add(int i, int j, double value) { matrix->add(i, j, value); }
};

struct ForceSink {
  static constexpr bool tangent = false;
  Eigen::VectorXd* force = nullptr;
  void member(int) {}
  void add_force(int i, double value) { (*force)[i] += value; }
  void add(int, int, double) {}
};

/// The tangent's quadratic form of each column of q, by member.
struct QuadraticSink {
  static constexpr bool tangent = true;
  const Eigen::MatrixXd* q = nullptr;
  Eigen::MatrixXd* energy = nullptr;
  int row = 0;
  void member(int m) { row = m < 0 ? static_cast<int>(energy->rows()) - 1 : m; }
  void add_force(int, double) {}
  void add(int i, int j, double value) {
    const double factor = i == j ? 0.5 * value : value;
    for (Eigen::Index c = 0; c < q->cols(); ++c) {
      (*energy)(row, c) += factor * (*q)(i, c) * (*q)(j, c);
    }
  }
};

/// Scatters local derivatives of edges, twists and node rotations to unknowns.
template <class Sink>
class Scatter {
 public:
  Scatter(const Chain& chain, const Numbering& numbering, Sink& sink)
      : chain_(chain), numbering_(numbering), sink_(sink) {}

  /// A block between nodes p and q (p == q: symmetric).
  template <int D>
  void nodes(int p, int q, const Eigen::Matrix<double, D, D>& block) {
    for (int i = 0; i < D; ++i) {
      const int row = numbering_.displacement(i, p);
      if (row < 0) continue;
      for (int j = p == q ? i : 0; j < D; ++j) {
        const int col = numbering_.displacement(j, q);
        if (col >= 0) sink_.add(row, col, block(i, j));
      }
    }
  }
  template <int D>
  void node_force(int p, const Eigen::Matrix<double, D, 1>& f) {
    for (int i = 0; i < D; ++i) {
      const int row = numbering_.displacement(i, p);
      if (row >= 0) sink_.add_force(row, f[i]);
    }
  }
  template <int D>
  void node_single(int p, int other, const Eigen::Matrix<double, D, 1>& column) {
    if (other < 0) return;
    for (int i = 0; i < D; ++i) {
      const int row = numbering_.displacement(i, p);
      if (row >= 0) sink_.add(row, other, column[i]);
    }
  }
  /// d2/de2 of one edge.
  template <int D>
  void edge(const Segment& s, const Eigen::Matrix<double, D, D>& block) {
    nodes<D>(s.a, s.a, block);
    nodes<D>(s.b, s.b, block);
    nodes<D>(s.a, s.b, -block);
  }
  template <int D>
  void edge_force(const Segment& s, const Eigen::Matrix<double, D, 1>& g) {
    node_force<D>(s.b, g);
    node_force<D>(s.a, -g);
  }
  /// Two successive edges (s.b == r.a): their own and mixed blocks.
  template <int D>
  void two_edges(const Segment& s, const Segment& r, const Eigen::Matrix<double, D, D>& ss,
                 const Eigen::Matrix<double, D, D>& sr, const Eigen::Matrix<double, D, D>& rr) {
    nodes<D>(s.a, s.a, ss);
    nodes<D>(r.b, r.b, rr);
    nodes<D>(s.b, s.b, ss + rr - sr - sr.transpose());
    nodes<D>(s.a, s.b, sr - ss);
    nodes<D>(s.a, r.b, -sr);
    nodes<D>(s.b, r.b, sr - rr);
  }
  void pair(int i, int j, double value) {
    if (i >= 0 && j >= 0) sink_.add(i, j, value);
  }
  void single_force(int i, double value) {
    if (i >= 0) sink_.add_force(i, value);
  }

  /// Two segments' (edge, twist) blocks.
  void two_segments(const InnerJoint& joint, const Matrix4& aa, const Matrix4& ab,
                    const Matrix4& bb) {
    const Segment& s = chain_.segments[static_cast<std::size_t>(joint.segment[0])];
    const Segment& r = chain_.segments[static_cast<std::size_t>(joint.segment[1])];
    two_edges<3>(s, r, aa.topLeftCorner<3, 3>(), ab.topLeftCorner<3, 3>(),
                 bb.topLeftCorner<3, 3>());
    const int ts = numbering_.twist[joint.segment[0]], tr = numbering_.twist[joint.segment[1]];
    if (ts < 0 && tr < 0) return;
    const Eigen::Vector3d s_ts = aa.topRightCorner<3, 1>(), s_tr = ab.topRightCorner<3, 1>();
    const Eigen::Vector3d r_ts = ab.bottomLeftCorner<1, 3>().transpose();
    const Eigen::Vector3d r_tr = bb.topRightCorner<3, 1>();
    node_single<3>(s.a, ts, -s_ts);
    node_single<3>(s.b, ts, s_ts - r_ts);
    node_single<3>(r.b, ts, r_ts);
    node_single<3>(s.a, tr, -s_tr);
    node_single<3>(s.b, tr, s_tr - r_tr);
    node_single<3>(r.b, tr, r_tr);
    pair(ts, ts, aa(3, 3));
    pair(tr, tr, bb(3, 3));
    pair(ts, tr, ab(3, 3));
  }
  /// A node's rotation (maybe fixed: -1) and a segment's (edge, twist).
  void node_segment(int rotation, int segment, const Eigen::Matrix3d& nn,
                    const Eigen::Matrix<double, 3, 4>& ns, const Matrix4& ss) {
    const Segment& s = chain_.segments[static_cast<std::size_t>(segment)];
    const int twist = numbering_.twist[segment];
    edge<3>(s, ss.topLeftCorner<3, 3>());
    const Eigen::Vector3d edge_twist = ss.topRightCorner<3, 1>();
    node_single<3>(s.a, twist, -edge_twist);
    node_single<3>(s.b, twist, edge_twist);
    pair(twist, twist, ss(3, 3));
    if (rotation < 0) return;
    const Eigen::Matrix3d& basis = chain_.rotation_basis[static_cast<std::size_t>(rotation)];
    const Eigen::Matrix3d local = basis.transpose() * nn * basis;
    const Eigen::Matrix<double, 3, 4> mixed = basis.transpose() * ns;
    for (int i = 0; i < 3; ++i) {
      const int row = numbering_.rotation(i, rotation);
      if (row < 0) continue;
      for (int j = i; j < 3; ++j) pair(row, numbering_.rotation(j, rotation), local(i, j));
      const Eigen::Vector3d e = mixed.row(i).head<3>().transpose();
      node_single<3>(s.a, row, -e);
      node_single<3>(s.b, row, e);
      pair(row, twist, mixed(i, 3));
    }
  }
  void rotation_force(int rotation, const Eigen::Vector3d& moment) {
    if (rotation < 0) return;
    const Eigen::Vector3d local =
        chain_.rotation_basis[static_cast<std::size_t>(rotation)].transpose() * moment;
    for (int i = 0; i < 3; ++i) single_force(numbering_.rotation(i, rotation), local[i]);
  }

 private:
  const Chain& chain_;
  const Numbering& numbering_;
  Sink& sink_;
};

/// The stiffnesses that act in the chain's present stage.
JointSprings acting(const Chain& chain, const EndJoint& joint) {
  JointSprings springs = joint.springs;
  if (joint.made_at_rest && !chain.settled) springs.about_1 = springs.about_2 = 0;
  return springs;
}

Eigen::Matrix3d node_side(const EndJoint& joint, const ChainState& state) {
  if (joint.rotation < 0) return joint.directors;
  return state.rotation[static_cast<std::size_t>(joint.rotation)] * joint.directors;
}

/// Bending stiffness about the plane's normal.
double in_plane_stiffness(const Segment& s, const ChainState& state, const JointSprings& springs) {
  if (s.frame < 0) return springs.about_1;
  return std::abs(state.director(2, s.frame)) > 0.5 ? springs.about_1 : springs.about_2;
}

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

struct Directed {
  Eigen::Matrix3d directors;
  double length = 0;
};

Directed directed(const Chain& chain, const ChainState& state, int segment) {
  Directed d;
  directors_of(chain, state, segment, d.directors, d.length);
  return d;
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

Assembly::Assembly(const Chain& chain, Motion motion)
    : chain_(&chain), numbering_(number_unknowns(chain, motion)) {}

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

void Assembly::length_derivative(const ChainState& state, int index,
                                 Eigen::VectorXd& derivative) const {
  // Axial force EA (|e| / l - 1): -EA |e| / l^2 by l = L / n; joints go with 1 / L, gravity with L.
  derivative.setZero(size());
  const ChainMember& member = chain_->members[static_cast<std::size_t>(index)];
  const double by_length = 1 / member.unstretched_length;
  ForceSink sink{&derivative};
  Scatter<ForceSink> scatter(*chain_, numbering_, sink);
  for (int i = 0; i < member.segments; ++i) {
    const int k = member.first_segment + i;
    const Segment& s = chain_->segments[static_cast<std::size_t>(k)];
    const Directed here = directed(*chain_, state, k);
    const Eigen::Vector3d t = here.directors.col(0);
    scatter.edge_force<3>(s, -s.EA * here.length / s.length * by_length * t);
    const Eigen::Vector3d weight = -s.mass / 2 * by_length * chain_->gravity;
    scatter.node_force<3>(s.a, weight);
    scatter.node_force<3>(s.b, weight);
    if (i == 0) continue;
    const JointSprings& springs =
        chain_->inner_joints[static_cast<std::size_t>(member.first_joint + i - 1)].springs;
    const Directed before = directed(*chain_, state, k - 1);
    const Eigen::Vector3d g =
        -by_length *
        joint_derivatives(before.directors, here.directors,
                          director_weights(springs.about_1, springs.about_2, springs.torsion))
            .gradient_b;
    const Vector4 ga = -segment_rotation(before.directors.col(0), before.length).transpose() * g;
    const Vector4 gb = segment_rotation(t, here.length).transpose() * g;
    scatter.edge_force<3>(chain_->segments[static_cast<std::size_t>(k - 1)], ga.head<3>());
    scatter.edge_force<3>(s, gb.head<3>());
    scatter.single_force(numbering_.twist[k - 1], ga[3]);
    scatter.single_force(numbering_.twist[k], gb[3]);
  }
  for (const int e : member.end_joint) {
    if (e < 0) continue;
    const EndJoint& joint = chain_->end_joints[static_cast<std::size_t>(e)];
    const JointSprings springs = acting(*chain_, joint);
    const Directed b = directed(*chain_, state, joint.segment);
    const Eigen::Vector3d g =
        -by_length *
        joint_derivatives(node_side(joint, state), b.directors,
                          director_weights(springs.about_1, springs.about_2, springs.torsion))
            .gradient_b;
    const Vector4 gb = segment_rotation(b.directors.col(0), b.length).transpose() * g;
    scatter.edge_force<3>(chain_->segments[static_cast<std::size_t>(joint.segment)], gb.head<3>());
    scatter.single_force(numbering_.twist[joint.segment], gb[3]);
    scatter.rotation_force(joint.rotation, -g);
  }
}

double Assembly::tension(const ChainState& state, int member) const {
  Eigen::VectorXd unused;
  double by_length = 0;
  double value = 0;
  tension_gradient(state, member, unused, by_length, &value);
  return value;
}

void Assembly::tension_gradient(const ChainState& state, int index, Eigen::VectorXd& gradient,
                                double& by_length, double* value) const {
  const ChainMember& member = chain_->members[static_cast<std::size_t>(index)];
  const Eigen::Vector3d h = member.tension_direction;
  const int middle = member.segments / 2;
  const int k = member.first_segment + middle;
  const Segment& s = chain_->segments[static_cast<std::size_t>(k)];
  const Directed here = directed(*chain_, state, k);
  const Eigen::Vector3d t = here.directors.col(0);
  const double force = s.EA * (here.length / s.length - 1);
  double tension = force * t.dot(h);
  by_length = -s.EA * here.length / s.length / member.unstretched_length * t.dot(h);
  // d (h . internal force) / de of the segment and of its neighbours.
  Eigen::Vector3d own =
      h * (force / here.length) + t * (t.dot(h) * (s.EA / s.length - force / here.length));
  const bool wanted = gradient.size() == size();
  if (wanted) gradient.setZero();
  ForceSink sink{&gradient};
  Scatter<ForceSink> scatter(*chain_, numbering_, sink);
  for (int side = 0; side < 2; ++side) {
    const int joint_index = middle - 1 + side;  // inner joint before, after
    if (joint_index < 0 || joint_index + 1 >= member.segments) continue;
    const InnerJoint& joint =
        chain_->inner_joints[static_cast<std::size_t>(member.first_joint + joint_index)];
    const int other = side == 0 ? k - 1 : k + 1;
    const Directed there = directed(*chain_, state, other);
    const RotationDerivatives d = joint_derivatives(
        there.directors, here.directors,
        director_weights(joint.springs.about_1, joint.springs.about_2, joint.springs.torsion));
    const auto jb = segment_rotation(t, here.length);
    const auto ja = segment_rotation(there.directors.col(0), there.length);
    const double shear = (jb.transpose() * d.gradient_b).head<3>().dot(h);
    tension += shear;
    by_length -= shear / member.unstretched_length;
    if (!wanted) continue;
    Matrix4 bb = jb.transpose() * d.same * jb;
    add_second_order(d.gradient_b, t, here.length, bb);
    const Matrix4 ab = ja.transpose() * d.cross * jb;
    own += bb.topLeftCorner<3, 3>() * h;
    scatter.single_force(numbering_.twist[k], bb.bottomLeftCorner<1, 3>().dot(h.transpose()));
    scatter.edge_force<3>(chain_->segments[static_cast<std::size_t>(other)],
                          ab.topLeftCorner<3, 3>() * h);
    scatter.single_force(numbering_.twist[other], ab.bottomLeftCorner<1, 3>().dot(h.transpose()));
  }
  if (wanted) scatter.edge_force<3>(s, own);
  if (value) *value = tension;
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
