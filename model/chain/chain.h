// A scene cut into rigid segments: nodes with three displacements, and what joins them.
//
// Segment i spans two nodes; its elongation is the axial spring (EA / l), its direction follows
// from the nodes, and only its twist is left over (kept where torque can enter). Segments meet at
// joints with bending and torsion springs (EI / l, GJ / l); a member's end meets a clamp, or a node
// at which several members are rigidly joined, through a joint of half a segment (2 EI / l). Such a
// node has a rotation of its own, without inertia.
//
// A joint between two sets of directors a_i, b_i (the material axes of its sides: tangent, about
// z, about the other transverse axis) stores
//   W = sum_i w_i (1 - a_i . b_i),  w_t = (K1 + K2 - K3) / 2,  w_1 = (K2 + K3 - K1) / 2, ...
// that is K (1 - cos phi) for a bend by phi: K phi^2 / 2 to second order, smooth at every angle,
// objective, no angles in it. Torsion by tau adds K3 (1 + cos phi)(1 - cos tau) / 2.
//
// Mass is lumped so that it is constant: m l (1/2 - c, c) between a segment's nodes, c = 1/6 for a
// rigid rod of rotary inertia m l^2 / 12. RotaryInertia::accurate takes the c and the joints'
// flexibility for which frequencies err by l^4 (segment_lumping.h); rigid_rod is the paper's.
#pragma once

#include "model/algebra/numbers.h"
#include "model/chain/segment_lumping.h"
#include "model/scene/scene.h"

namespace rigfit::model {

struct ChainOptions {
  std::vector<int> segments;  ///< by member; empty or zero: the member's own number (30 if "auto")
  RotaryInertia rotary_inertia = RotaryInertia::accurate;
  std::optional<bool> torsion;  ///< else where torque can enter (model_reduction.h)
  /// By member: where its segments end, rising from 0 to 1 of the unstretched length; empty: all
  /// segments are of one length. Goes before `segments`.
  std::vector<std::vector<double>> places;
};

struct Segment {
  int a = 0, b = 0;  ///< nodes, in the member's direction
  int member = 0;
  /// Column of ChainState::director; -1: no torsion, both bending stiffnesses equal.
  int frame = -1;
  double length = 0;         ///< m, unstretched
  double EA = 0;             ///< N
  double mass = 0;           ///< kg
  double axial_damping = 0;  ///< N s / m
  double polar = 0;          ///< kg m^2 about its axis
  /// Share of the mass that couples the two nodes; each node has 1/2 - coupling.
  double coupling = 1.0 / 6;
};

/// Stiffnesses of a joint (N m / rad) about the member's material axes, and its dampers (N m s).
struct JointSprings {
  double about_1 = 0, about_2 = 0, torsion = 0;
  double bending_damping = 0, torsion_damping = 0;
};

/// Between two successive segments of a member.
struct InnerJoint {
  int segment[2] = {0, 0};
  JointSprings springs;
};

/// Between a member's end segment and a node that holds its direction or only its twist.
struct EndJoint {
  int segment = 0;
  int rotation = -1;  ///< column of ChainState::rotation; -1: fixed
  JointSprings springs;
  bool stress_free_at_equilibrium = false;  ///< a hanging cable's: no moment at the equilibrium
  /// The node's side at no rotation of the node: columns tangent, axis 1, axis 2.
  Matrix3d directors = Matrix3d::Identity();
};

/// A spring between a node and the ground.
struct NodeSupport {
  int node = 0;
  int rotation = -1;
  Vector3d translational = Vector3d::Zero();  ///< N / m along the chain's axes
  Vector3d rotational = Vector3d::Zero();     ///< N m / rad about them
};

/// A point of the chain that a load acts on or a sensor sits at: weights of up to four nodes
/// (cubic interpolation along the member, linear for fewer than three segments).
struct ChainPoint {
  std::array<int, 4> node{-1, -1, -1, -1};
  std::array<double, 4> weight{0, 0, 0, 0};
  int count = 0;
  int segment = -1;  ///< that the place lies in; at a node: of the first member that ends there
};

struct PointMass {
  int node[2] = {0, 0};
  double fraction = 0;  ///< 0: all at node[0]
  double mass = 0;      ///< kg
  int member = -1;      ///< -1: a node's
};

struct ChainMember {
  bool cable = true;
  int first_segment = 0;
  int segments = 0;
  int first_joint = 0;                   ///< index of the first of segments - 1 inner joints
  std::array<int, 2> end_joint{-1, -1};  ///< at each end; -1: moment-free
  std::vector<int> nodes;                ///< segments + 1, from the first node to the second
  /// Places of the nodes, 0..1 of the unstretched length.
  std::vector<double> places;
  bool even = true;                      ///< segments alike, to the last digit
  double unstretched_length = 0;         ///< m
  std::optional<double> target_tension;  ///< N: the unstretched length is to be found
  Vector3d tension_direction{1, 0, 0};   ///< unit: horizontal, or the chord if that is steep

  /// The segment, from 0, that a place lies in.
  [[nodiscard]] int segment_at(double s) const;
};

/// Everything of a rig that does not move. The unstretched lengths may be set anew (they are
/// unknowns of the equilibrium), which rescales the member's segments; end joints are set to rest.
struct Chain {
  Matrix3d axes = Matrix3d::Identity();  ///< chain axes = axes * scene axes
  Vector3d gravity = Vector3d::Zero();   ///< m/s^2, chain axes
  bool planar = false;  ///< chain's x, y plane is one of symmetry of the scene at rest

  int nodes = 0;             ///< the scene's, in its order, then those inside members
  int scene_nodes = 0;       ///< how many those of the scene are
  int frames = 0;            ///< zero: no torsion
  std::vector<int> along;    ///< all nodes, neighbours near each other
  Matrix3Xd drawn;           ///< 3 x nodes, chain axes: straight between the scene's nodes
  Matrix3Xd drawn_director;  ///< 3 x frames: material axis 1 of the straight members
  Eigen::Matrix<bool, 3, Eigen::Dynamic> fixed;  ///< displacement held, 3 x nodes
  std::vector<int> rotating_node;                ///< chain node of each node rotation
  /// Axes a node may turn about (columns) and which of them it may not: those without stiffness,
  /// such as a cable's own axis where it transmits no torque.
  std::vector<Matrix3d> rotation_basis;
  Eigen::Matrix<bool, 3, Eigen::Dynamic> rotation_fixed;  ///< 3 x rotations
  /// False while the equilibrium is sought: joints stress-free at equilibrium bear no bending
  /// moment yet.
  bool settled = false;

  std::vector<ChainMember> members;
  std::vector<Segment> segments;
  std::vector<InnerJoint> inner_joints;
  std::vector<EndJoint> end_joints;
  std::vector<NodeSupport> supports;
  std::vector<PointMass> masses;
  std::vector<ChainPoint> loads, sensors;                  ///< in the scene's order
  std::vector<Vector3d> load_direction, sensor_direction;  ///< chain axes
  RotaryInertia rotary_inertia = RotaryInertia::accurate;

  /// `members` are the scene's, in its order. Throws SceneError for a member or place that names no
  /// node or member of the scene.
  [[nodiscard]] static Chain from_scene(const Scene& scene, const ChainOptions& options = {});
  /// Numbers of segments, by member.
  [[nodiscard]] std::vector<int> segment_counts() const;
  /// Rescales segment lengths, springs and masses of a member.
  void set_unstretched_length(int member, double length);
};

/// Where a chain is. Directors and rotations are updated by increments (`advance` in assembly.h).
struct ChainState {
  Matrix3Xd position;  ///< m, 3 x nodes, chain axes
  Matrix3Xd director;  ///< 3 x frames: unit, normal to its segment
  /// Rotation of each rotating node from its drawn attitude.
  std::vector<Matrix3d> rotation;
};

/// Sets the directors of all joints stress-free at equilibrium to the given equilibrium, and
/// `settled`.
void settle(Chain& chain, const ChainState& state);
/// A segment's direction: columns tangent, axis 1, axis 2 (axes zero where it has no frame), and
/// |e|.
struct Directed {
  Matrix3d directors;
  double length = 0;
};
[[nodiscard]] Directed directed(const Chain& chain, const ChainState& state, int segment);
/// EA/l (|e| - l) of every segment, N.
[[nodiscard]] VectorXd axial_forces(const Chain& chain, const ChainState& state);
/// Directors of `from` in `to`, whose segments have turned without twisting.
void carry_frames(const Chain& chain, const ChainState& from, ChainState& to);
/// A vector normal to the unit vector `from`, after parallel transport normal to `to`.
[[nodiscard]] Vector3d transported(const Vector3d& d, const Vector3d& from, const Vector3d& to);

/// As drawn: members straight, nothing turned.
[[nodiscard]] ChainState drawn_state(const Chain& chain);
/// Position of a place, chain axes.
[[nodiscard]] Vector3d position_of(const ChainPoint& point, const Matrix3Xd& position);

}  // namespace rigfit::model
