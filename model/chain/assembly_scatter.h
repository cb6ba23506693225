// Derivatives of the energy of a chain's joints, and where derivatives go: from edges, twists and
// node rotations to the unknowns of a motion. Inside `assembly*.cc`.
//
// A joint's energy is W = sum w_i (1 - a_i . b_i) between two sets of directors. With rotation
// vectors psi_A, psi_B of the two sides and S = sum w_i b_i a_i' (3 x 3):
//   dW/dpsi_A = -sum w_i a_i x b_i = -dW/dpsi_B
//   d2W/dpsi_A2 = d2W/dpsi_B2 = tr(S) I - (S + S') / 2,   d2W/dpsi_A dpsi_B = S - tr(S) I
// (second variation of a -> a + psi x a + psi x (psi x a) / 2). A segment's rotation vector follows
// from its edge increment de and twist theta (twist, then parallel transport) as
//   psi = t x de / |e| + theta t - (t . de)(t x de) / |e|^2 + theta de_normal / (2 |e|) + O(3).
#pragma once

#include <Eigen/Geometry>

#include "model/algebra/envelope_matrix.h"
#include "model/algebra/numbers.h"
#include "model/chain/chain.h"
#include "model/chain/numbering.h"

namespace rigfit::model {

using Matrix4 = Eigen::Matrix4d;

/// Weights w of the three director pairs.
inline Vector3d director_weights(double about_1, double about_2, double torsion) {
  return 0.5 * Vector3d(about_1 + about_2 - torsion, about_2 + torsion - about_1,
                        about_1 + torsion - about_2);
}

/// 1 - a . b = |a - b|^2 / 2 of unit vectors, without cancellation.
inline double joint_energy(const Matrix3d& a, const Matrix3d& b, const Vector3d& w) {
  return 0.5 * w.dot((a - b).colwise().squaredNorm().transpose());
}

struct RotationDerivatives {
  Vector3d gradient_b;   ///< gradient with respect to side B; that of side A is its negative
  Matrix3d same, cross;  ///< d2/dA2 = d2/dB2; d2/dA dB (rows A)
};

inline RotationDerivatives joint_derivatives(const Matrix3d& a, const Matrix3d& b,
                                             const Vector3d& w) {
  RotationDerivatives d;
  const Matrix3d s = b * w.asDiagonal() * a.transpose();
  // sum w a x b is the axial vector of S - S'.
  d.gradient_b << s(2, 1) - s(1, 2), s(0, 2) - s(2, 0), s(1, 0) - s(0, 1);
  const double trace = s.trace();
  d.same = -0.5 * (s + s.transpose());
  d.same.diagonal().array() += trace;
  d.cross = s;
  d.cross.diagonal().array() -= trace;
  return d;
}

/// Columns de (3), as t x de / |e| = [t] de / |e|, and twist of d psi.
inline Eigen::Matrix<double, 3, 4> segment_rotation(const Directed& segment) {
  const Vector3d t = segment.directors.col(0), f = t / segment.length;
  Eigen::Matrix<double, 3, 4> j;
  j << 0, -f.z(), f.y(), t.x(), f.z(), 0, -f.x(), t.y(), -f.y(), f.x(), 0, t.z();
  return j;
}

/// Adds what the second-order part of psi gives to the Hessian in (de, twist), for a moment
/// `gradient` = dW/dpsi.
inline void add_second_order(const Vector3d& gradient, const Directed& segment, Matrix4& hessian) {
  const Vector3d t = segment.directors.col(0);
  const double length = segment.length;
  const Vector3d c = gradient.cross(t) / (length * length);
  hessian.topLeftCorner<3, 3>() -= c * t.transpose() + t * c.transpose();
  const Vector3d half = (gradient - t * t.dot(gradient)) / (2 * length);
  hessian.topRightCorner<3, 1>() += half;
  hessian.bottomLeftCorner<1, 3>() += half.transpose();
}

/// Where the energy and its derivatives go: nowhere.
struct NoSink {
  static constexpr bool tangent = false;
  void member(int) {}
  void add_energy(double) {}
  void add_force(int, double) {}
  void add(int, int, double) {}
};

struct EnergySink : NoSink {
  double energy = 0;
  void add_energy(double value) { energy += value; }
};

/// To a force vector and an envelope matrix.
struct MatrixSink : NoSink {
  static constexpr bool tangent = true;
  double* force = nullptr;
  EnvelopeMatrix* matrix = nullptr;
  void add_force(int i, double value) {
    if (force) force[i] += value;
  }
  void add(int i, int j, double value) { matrix->add(i, j, value); }
};

struct ForceSink : NoSink {
  double* force = nullptr;
  void add_force(int i, double value) { force[i] += value; }
};

/// The tangent's quadratic form of each column of q, by member.
struct QuadraticSink : NoSink {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  static constexpr bool tangent = true;
  const Rows* q = nullptr;
  Rows* energy = nullptr;
  int row = 0;
  void member(int m) { row = m < 0 ? static_cast<int>(energy->rows()) - 1 : m; }
  void add(int i, int j, double value) {
    energy->row(row) += (i == j ? 0.5 * value : value) * q->row(i).cwiseProduct(q->row(j));
  }
};

/// Scatters local derivatives of edges, twists and node rotations to unknowns.
template <class Sink>
class Scatter {
 public:
  Scatter(const Chain& chain, const Numbering& numbering, Sink& sink)
      : chain_(chain), numbering_(numbering), sink_(sink) {}

  /// A block between nodes p and q (p == q: symmetric).
  void nodes(int p, int q, const Matrix3d& block) {
    for (int i = 0; i < 3; ++i) {
      const int row = numbering_.displacement(i, p);
      if (row < 0) continue;
      for (int j = p == q ? i : 0; j < 3; ++j) {
        const int col = numbering_.displacement(j, q);
        if (col >= 0) sink_.add(row, col, block(i, j));
      }
    }
  }
  void node_force(int p, const Vector3d& f) {
    for (int i = 0; i < 3; ++i) {
      const int row = numbering_.displacement(i, p);
      if (row >= 0) sink_.add_force(row, f[i]);
    }
  }
  void node_single(int p, int other, const Vector3d& column) {
    if (other < 0) return;
    for (int i = 0; i < 3; ++i) {
      const int row = numbering_.displacement(i, p);
      if (row >= 0) sink_.add(row, other, column[i]);
    }
  }
  /// d2/de2 of one edge.
  void edge(const Segment& s, const Matrix3d& block) {
    nodes(s.a, s.a, block);
    nodes(s.b, s.b, block);
    nodes(s.a, s.b, -block);
  }
  void edge_force(const Segment& s, const Vector3d& g) {
    node_force(s.b, g);
    node_force(s.a, -g);
  }
  /// Two successive edges (s.b == r.a): their own and mixed blocks.
  void two_edges(const Segment& s, const Segment& r, const Matrix3d& ss, const Matrix3d& sr,
                 const Matrix3d& rr) {
    nodes(s.a, s.a, ss);
    nodes(r.b, r.b, rr);
    nodes(s.b, s.b, ss + rr - sr - sr.transpose());
    nodes(s.a, s.b, sr - ss);
    nodes(s.a, r.b, -sr);
    nodes(s.b, r.b, sr - rr);
  }
  /// From the moment on a segment: psi = t x de / |e| + theta t.
  void segment_force(int segment, const Directed& here, const Vector3d& moment) {
    const Vector3d t = here.directors.col(0);
    edge_force(chain_.segments[at(segment)], moment.cross(t) / here.length);
    single_force(numbering_.twist[segment], t.dot(moment));
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
    const Segment& s = chain_.segments[at(joint.segment[0])];
    const Segment& r = chain_.segments[at(joint.segment[1])];
    two_edges(s, r, aa.topLeftCorner<3, 3>(), ab.topLeftCorner<3, 3>(), bb.topLeftCorner<3, 3>());
    const int ts = numbering_.twist[joint.segment[0]], tr = numbering_.twist[joint.segment[1]];
    if (ts < 0 && tr < 0) return;
    const Vector3d s_ts = aa.topRightCorner<3, 1>(), s_tr = ab.topRightCorner<3, 1>();
    const Vector3d r_ts = ab.bottomLeftCorner<1, 3>().transpose();
    const Vector3d r_tr = bb.topRightCorner<3, 1>();
    node_single(s.a, ts, -s_ts);
    node_single(s.b, ts, s_ts - r_ts);
    node_single(r.b, ts, r_ts);
    node_single(s.a, tr, -s_tr);
    node_single(s.b, tr, s_tr - r_tr);
    node_single(r.b, tr, r_tr);
    pair(ts, ts, aa(3, 3));
    pair(tr, tr, bb(3, 3));
    pair(ts, tr, ab(3, 3));
  }
  /// A node's rotation (maybe fixed: -1) and a segment's (edge, twist).
  void node_segment(int rotation, int segment, const Matrix3d& nn,
                    const Eigen::Matrix<double, 3, 4>& ns, const Matrix4& ss) {
    const Segment& s = chain_.segments[at(segment)];
    const int twist = numbering_.twist[segment];
    edge(s, ss.topLeftCorner<3, 3>());
    const Vector3d edge_twist = ss.topRightCorner<3, 1>();
    node_single(s.a, twist, -edge_twist);
    node_single(s.b, twist, edge_twist);
    pair(twist, twist, ss(3, 3));
    if (rotation < 0) return;
    node_rotation(rotation, nn);
    const Eigen::Matrix<double, 3, 4> mixed = chain_.rotation_basis[at(rotation)].transpose() * ns;
    for (int i = 0; i < 3; ++i) {
      const int row = numbering_.rotation(i, rotation);
      if (row < 0) continue;
      const Vector3d e = mixed.row(i).head<3>().transpose();
      node_single(s.a, row, -e);
      node_single(s.b, row, e);
      pair(row, twist, mixed(i, 3));
    }
  }
  void node_rotation(int rotation, const Matrix3d& block) {
    const Matrix3d& basis = chain_.rotation_basis[at(rotation)];
    const Matrix3d local = basis.transpose() * block * basis;
    const auto unknown = numbering_.rotation.col(rotation);
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) pair(unknown[i], unknown[j], local(i, j));
    }
  }
  void rotation_force(int rotation, const Vector3d& moment) {
    if (rotation < 0) return;
    const Vector3d local = chain_.rotation_basis[at(rotation)].transpose() * moment;
    for (int i = 0; i < 3; ++i) single_force(numbering_.rotation(i, rotation), local[i]);
  }

 private:
  const Chain& chain_;
  const Numbering& numbering_;
  Sink& sink_;
};

/// The stiffnesses that act in the chain's present stage.
inline JointSprings acting(const Chain& chain, const EndJoint& joint) {
  JointSprings springs = joint.springs;
  if (joint.stress_free_at_equilibrium && !chain.settled) springs.about_1 = springs.about_2 = 0;
  return springs;
}

inline Matrix3d node_side(const EndJoint& joint, const ChainState& state) {
  if (joint.rotation < 0) return joint.directors;
  return state.rotation[at(joint.rotation)] * joint.directors;
}

/// A member's joints, those at its ends included, `factor` times as stiff as they are.
template <class Sink>
void member_joints(const Chain& chain, const ChainState& state, const ChainMember& member,
                   double factor, Scatter<Sink>& scatter, Sink& sink) {
  const auto weights = [factor](const JointSprings& k) {
    return Vector3d(factor * director_weights(k.about_1, k.about_2, k.torsion));
  };
  for (int i = 1; i < member.segments; ++i) {
    const InnerJoint& joint = chain.inner_joints[at(member.first_joint + i - 1)];
    const Vector3d w = weights(joint.springs);
    if (w.isZero(0)) continue;
    const Directed a = directed(chain, state, joint.segment[0]);
    const Directed b = directed(chain, state, joint.segment[1]);
    const RotationDerivatives d = joint_derivatives(a.directors, b.directors, w);
    sink.add_energy(joint_energy(a.directors, b.directors, w));
    scatter.segment_force(joint.segment[0], a, -d.gradient_b);
    scatter.segment_force(joint.segment[1], b, d.gradient_b);
    if constexpr (Sink::tangent) {
      const Eigen::Matrix<double, 3, 4> ja = segment_rotation(a), jb = segment_rotation(b);
      Matrix4 aa = ja.transpose() * d.same * ja, bb = jb.transpose() * d.same * jb;
      add_second_order(-d.gradient_b, a, aa);
      add_second_order(d.gradient_b, b, bb);
      scatter.two_segments(joint, aa, ja.transpose() * d.cross * jb, bb);
    }
  }
  for (const int index : member.end_joint) {
    if (index < 0) continue;
    const EndJoint& joint = chain.end_joints[at(index)];
    const Vector3d w = weights(acting(chain, joint));
    if (w.isZero(0)) continue;
    const Matrix3d node = node_side(joint, state);
    const Directed b = directed(chain, state, joint.segment);
    const RotationDerivatives d = joint_derivatives(node, b.directors, w);
    sink.add_energy(joint_energy(node, b.directors, w));
    scatter.segment_force(joint.segment, b, d.gradient_b);
    scatter.rotation_force(joint.rotation, -d.gradient_b);
    if constexpr (Sink::tangent) {
      const Eigen::Matrix<double, 3, 4> j = segment_rotation(b);
      Matrix4 ss = j.transpose() * d.same * j;
      add_second_order(d.gradient_b, b, ss);
      scatter.node_segment(joint.rotation, joint.segment, d.same, d.cross * j, ss);
    }
  }
}

}  // namespace rigfit::model
