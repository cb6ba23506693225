// Where the derivatives of a chain's energy go: from edges, twists and node rotations to the
// unknowns of a motion. Inside `assembly*.cc`.
#pragma once

#include "model/chain/joint_energy.h"
#include "model/chain/numbering.h"

namespace rigfit::model {

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
inline JointSprings acting(const Chain& chain, const EndJoint& joint) {
  JointSprings springs = joint.springs;
  if (joint.stress_free_at_equilibrium && !chain.settled) springs.about_1 = springs.about_2 = 0;
  return springs;
}

inline Eigen::Matrix3d node_side(const EndJoint& joint, const ChainState& state) {
  if (joint.rotation < 0) return joint.directors;
  return state.rotation[static_cast<std::size_t>(joint.rotation)] * joint.directors;
}

/// Bending stiffness about the plane's normal.
inline double in_plane_stiffness(const Segment& s, const ChainState& state,
                                 const JointSprings& springs) {
  if (s.frame < 0) return springs.about_1;
  return std::abs(state.director(2, s.frame)) > 0.5 ? springs.about_1 : springs.about_2;
}

struct Directed {
  Eigen::Matrix3d directors;
  double length = 0;
};

inline Directed directed(const Chain& chain, const ChainState& state, int segment) {
  Directed d;
  directors_of(chain, state, segment, d.directors, d.length);
  return d;
}

}  // namespace rigfit::model
