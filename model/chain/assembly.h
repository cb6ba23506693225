// Energy, internal forces, tangent stiffness, mass and damping of a chain in a given state, in the
// unknowns of one of its motions.
//
// A scene whose x, y plane (chain axes) is one of symmetry moves in it (two displacements a node,
// one rotation) and, to first order, out of it independently (one displacement a node, the twists,
// two rotations). Space has them all. The tangent is the second derivative of the energy for
// increments of the state as `advance` applies them: displacements; the twist of a segment after
// parallel transport of its frame; the rotation vector of a node (spatial). It is symmetric.
//
// An Assembly is const while states are evaluated; it holds a reference to the chain, whose lengths
// and rest directors may change in between.
#pragma once

#include <Eigen/SparseCore>

#include "model/algebra/envelope_matrix.h"
#include "model/algebra/numbers.h"
#include "model/chain/chain.h"
#include "model/chain/numbering.h"

namespace rigfit::model {

class Assembly {
 public:
  Assembly(const Chain& chain, Motion motion);

  [[nodiscard]] const Chain& chain() const { return *chain_; }
  [[nodiscard]] const Numbering& numbering() const { return numbering_; }
  [[nodiscard]] int size() const { return numbering_.size; }
  [[nodiscard]] EnvelopeMatrix matrix() const { return EnvelopeMatrix(numbering_.envelope); }

  /// force = d(elastic + gravity energy)/dq, N: zero in equilibrium without other loads. `force`
  /// must have the size of the unknowns.
  void force(const ChainState& state, VectorXd& force) const;
  /// The same and its derivative. `axial_force` (N, by segment; may be null) replaces the axial
  /// force in the geometric stiffness N P / |e| only: with the force extrapolated linearly from
  /// the last step, Newton's method on stiff chains takes large steps without trouble.
  void force_and_tangent(const ChainState& state, VectorXd& force, EnvelopeMatrix& tangent,
                         const VectorXd* axial_force = nullptr) const;
  /// Constant; the rotations of nodes, and twists without polar inertia, have none.
  void mass(EnvelopeMatrix& mass) const;
  /// Joint dampers at this state: C with force C qdot, symmetric and non-negative.
  void damping(const ChainState& state, EnvelopeMatrix& damping) const;

  /// state advanced by increments: out = state (+) factor * increment. `out` may be `state`.
  void advance(const ChainState& state, const VectorXd& increment, double factor,
               ChainState& out) const;

  /// Segments x unknowns: how fast each segment's length grows with the unknowns.
  [[nodiscard]] Eigen::SparseMatrix<double, Eigen::RowMajor> elongations(
      const ChainState& state) const;
  /// Gravity's forces, N.
  [[nodiscard]] VectorXd weight() const;
  /// Elastic and gravity energy, J.
  [[nodiscard]] double potential(const ChainState& state) const;
  /// q_r' K_m q_r / 2 of each member m (rows; the last: supports) and each column q_r: the tangent
  /// stiffness' share of energy, tension included.
  [[nodiscard]] MatrixXd stiffness_energy(const ChainState& state, const MatrixXd& q) const;

  /// d force / d (unstretched length of a member), at fixed state.
  void length_derivative(const ChainState& state, int member, Ref<VectorXd> derivative) const;
  /// The member's tension at its middle, N: component along its tension direction of the internal
  /// force (axial and shear) of its middle segment and of the weight from there; its derivatives.
  [[nodiscard]] double tension(const ChainState& state, int member) const;
  /// `gradient` by the unknowns (skipped unless it has their size), `by_length` by the member's
  /// unstretched length. Exact for members without a frame; with one the product of torque and
  /// curvature is left out. Returns the tension.
  double tension_gradient(const ChainState& state, int member, Ref<VectorXd> gradient,
                          double& by_length) const;

  /// Weights of a point's motion along a direction: displacement = row . q. Also the generalised
  /// force of a unit load there.
  [[nodiscard]] VectorXd row_of(const ChainPoint& point, const Vector3d& direction) const;

 private:
  const Chain* chain_;
  Numbering numbering_;
};

}  // namespace rigfit::model
