// The constant mass of a chain whose only inertia is that of its nodes, and its inverse, over
// entries: every member's nodes one after the other, component after component, a node that members
// share having an entry in each.
//
// A member's mass is tridiagonal, the same in every component; its inner nodes are eliminated, the
// nodes at members' ends remain in a small matrix that is inverted once.
//
// Axial waves can be slowed ("selective mass scaling", L. Olovsson, K. Simonsson and M. Unosson,
// Int. J. Numer. Meth. Engng 63 (2005) 1436-1445): kappa times the axial stiffness EA/l along each
// member's chord is added to the mass, so that a wave of frequency omega along it has omega^2 /
// (1 + kappa omega^2) instead of omega^2: what is slow against 1 / sqrt(kappa) keeps its speed and
// what is fast no longer sets the step.
#pragma once

#include "model/algebra/numbers.h"
#include "model/motion/lane_loops.h"

namespace rigfit::model {

template <int D>
class NodeMass {
 public:
  struct Member {
    int offset = 0, segments = 0, rows = 0;
    std::vector<int> entry;    ///< entry of each node
    int shared[2] = {-1, -1};  ///< index of the end nodes
    /// Masses at segments + 1 nodes and couplings between them, kg. That of a shared node is in one
    /// member alone.
    std::vector<double> diagonal, off;
    std::vector<double> axial;  ///< EA / l of the segments, N / m
  };
  struct Shared {
    std::vector<int> entries;
    bool held[3] = {false, false, false};
  };

  NodeMass() = default;
  NodeMass(const std::vector<Member>& members, std::vector<Shared> shared, int entries);

  /// `kappa` in s^2, zero: all waves at their own speed. `positions`: entries, gives the chords.
  void slow_axial(double kappa, const double* positions);
  [[nodiscard]] double kappa() const { return kappa_; }

  /// Forces to accelerations, in place. A shared node's force is the sum of its entries'; its
  /// acceleration is put in all of them, zero where held. Not thread-safe (own scratch space).
  void solve(double* values);

  /// x . (M y), with what slowing axial waves by `kappa` adds.
  [[nodiscard]] double product(const double* x, const double* y, double kappa) const;

 private:
  // Factors of a member's inner nodes, and what they take from and give to the end nodes.
  struct Inner {
    LaneFactors factors;
    LaneVector from[2];  // by end: M_ii^-1 times the coupling to its node, whose own is -1
    double off[2] = {};  // coupling to the inner neighbours
    double own[2] = {}, both = 0;  // reduced mass of the end nodes
  };
  struct Plan : Member {
    Inner plain, slowed;
    int along = -1;        // component that takes the slowed mass; -1: none
    bool rotated = false;  // solved in `axes`, whose first column is the chord
    Eigen::Matrix<double, D, D> axes = Eigen::Matrix<double, D, D>::Identity();
  };
  struct Free {
    int node, component;
  };

  static Inner factor(const Member& member, double kappa);
  void reduce();
  void rotate(const Plan& plan, bool back, double* values) const;
  void solve_ends(double* values);

  std::vector<Plan> plans_;
  std::vector<Shared> shared_;
  int entries_ = 0;
  double kappa_ = 0;
  bool any_rotated_ = false;
  std::vector<Free> free_;       // components of shared nodes that move, node by node
  std::vector<int> first_free_;  // first free component of each shared node; -1: held altogether
  MatrixXd inverse_;             // inverse of the free components' reduced mass
  VectorXd force_, motion_;
  const LaneLoops<D>* loops_ = &lane_loops<D>();
};

extern template class NodeMass<2>;
extern template class NodeMass<3>;

}  // namespace rigfit::model
