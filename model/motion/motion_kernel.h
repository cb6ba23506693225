// Accelerations of a chain whose only inertia is that of its nodes, fast enough for a million
// evaluations a second: what explicit time integration spends its time on.
//
// The same energies as Assembly's (chain.h), written for two or three components (D) over arrays in
// which every member's nodes lie in lane order (lane_loops.h: "entries", padding included; a node
// that members share has an entry in each). A joint between directions t_i, t_j stores K (1 - t_i .
// t_j), so with e_i the segment's vector and L its length
//   dV/de_i = EA/l (L - l) t_i - (I - t_i t_i') g_i / L,   g_i = sum over its joints of K t_other
// without any angle. A node's rotation has no inertia and follows: in the plane its angle is
// the argument of the sum of K t conj(d) over the members (and the ground's spring) joined there.
// The mass is constant (node_mass.h).
#pragma once

#include "model/algebra/numbers.h"
#include "model/chain/assembly.h"
#include "model/chain/chain.h"
#include "model/motion/lane_loops.h"
#include "model/motion/node_mass.h"

namespace rigfit::model {

/// Values of all entries, read.
using Entries = Ref<const VectorXd>;

/// In the plane (2) always, unless the plane is not one of symmetry; in space (3) for chains
/// without torsion and without turning nodes.
[[nodiscard]] bool kernel_supports(const Chain& chain, int dimensions);

template <int D>
class MotionKernel {
 public:
  /// The chain must be supported and settled (its equilibrium found).
  explicit MotionKernel(const Chain& chain);

  /// Length of the arrays below: D times the entries, component after component.
  [[nodiscard]] int size() const { return D * entries_; }

  [[nodiscard]] VectorXd positions(const ChainState& state) const;
  /// The state with these positions; rotations as they follow.
  [[nodiscard]] ChainState state(const Entries& positions);
  /// Rates of its unknowns for velocities of the entries (those of turning nodes zero).
  [[nodiscard]] VectorXd unknowns(const Entries& entries) const;
  /// The way back: entries from the unknowns.
  [[nodiscard]] VectorXd entry_values(const VectorXd& unknowns) const;
  /// Weights of the unknowns as weights of entries: those of a shared node are in its first.
  [[nodiscard]] VectorXd covector(const VectorXd& weights) const;

  /// acceleration = M^-1 (external - dV/dx), zero where held. Entries' arrays; `external` (N, may
  /// be null) is given in any one of a shared node's entries or split among them. Not thread-safe:
  /// uses the kernel's own scratch space.
  void acceleration(const double* positions, const double* external, double* acceleration);

  /// x . (M y) for two arrays of entries (momentum, kinetic energy), and the same with what slowing
  /// the axial waves adds.
  [[nodiscard]] double mass_product(const Entries& x, const Entries& y) const {
    return mass_.product(x.data(), y.data(), 0);
  }
  [[nodiscard]] double slowed_product(const Entries& x, const Entries& y) const {
    return mass_.product(x.data(), y.data(), mass_.kappa());
  }
  /// From here on accelerations are those of a mass that slows axial waves (node_mass.h) along the
  /// members' chords in the given positions; zero gives all waves their own speed again.
  void slow_axial(double kappa, const Entries& positions) {
    mass_.slow_axial(kappa, positions.data());
  }
  [[nodiscard]] double kappa() const { return mass_.kappa(); }
  /// Potential energy, J.
  [[nodiscard]] double potential(const Entries& positions) {
    return assembly_.potential(state(positions));
  }

  /// Weights of a point's motion along a direction, without what is held: displacement = row . x.
  [[nodiscard]] VectorXd row(const ChainPoint& point, const Vector3d& direction) const {
    return covector(assembly_.row_of(point, direction));
  }
  /// Rates of the segments' lengths, m/s, for velocities of the entries; in the directions that
  /// the last acceleration was taken at.
  void stretch(const double* velocities, VectorXd& rates) const;
  /// Adds thrusts that lengthen the segments (or impulses) to the entries' forces, in these
  /// directions.
  void push(const float* thrusts, double* forces) const;
  /// Impulses of the entries become velocities.
  void velocities(double* impulses) { mass_.solve(impulses); }
  /// Axial force of a segment, N.
  [[nodiscard]] double axial_force(int segment, const double* positions) const;

 private:
  struct MemberPlan : NodeMass<D>::Member {
    LaneMember lanes;
    std::vector<double> joint;  // segments + 1: N m / rad, the first and last are end joints
    Eigen::Matrix<double, 3, 2> end_direction;  // the node's side of the end joints, unturned
    // Where the directions of an end's segment and of its joint's other side stand.
    [[nodiscard]] int end_segment(int end) const {
      return this->entry[end == 0 ? 0 : at(this->segments - 1)];
    }
    [[nodiscard]] int end_side(int end) const {
      return end == 0 ? this->offset + kLanes * this->rows - 1 : this->entry.back();
    }
  };
  struct SharedNode : NodeMass<D>::Shared {
    int node = 0;
    Vector3d spring = Vector3d::Zero();  // to the ground
    Vector3d anchor = Vector3d::Zero();
  };
  struct Turning {
    struct End {
      int member, end;
      double stiffness;
    };
    std::vector<End> ends;
    double spring = 0;  // N m / rad, to the ground: K (1 - cos)
    bool held = false;
    double cosine = 1, sine = 0;  // cosine and sine of the node's angle
  };

  void make_members();
  void set_lanes(const ChainMember& member, MemberPlan& plan);
  void tangents(const double* positions);
  [[nodiscard]] LaneScratch scratch(const MemberPlan& plan);
  void turn_nodes();
  template <class Visit>
  void each_segment(const Visit& visit) const;

  const Chain* chain_;
  Assembly assembly_;
  int entries_ = 0;
  std::vector<MemberPlan> members_;
  std::vector<SharedNode> shared_;
  std::vector<Turning> turning_;
  std::vector<int> entry_of_node_;
  VectorXd gravity_;  // D x entries
  NodeMass<D> mass_;
  bool springs_ = false;
  const LaneLoops<D>* loops_ = &lane_loops<D>();
  // Scratch: directions, 1/L, axial force.
  LaneVector direction_[D], inverse_length_, axial_force_;
};

extern template class MotionKernel<2>;
extern template class MotionKernel<3>;

}  // namespace rigfit::model
