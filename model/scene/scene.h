// Description of a rig: nodes, members, loads and sensors, as plain data in SI. `read_scene` fills
// and checks it; the segment chain is built from it.
//
// Axes: x along the cables, y up, z out of plane. Mass and stiffness are per unstretched length.
#pragma once

#include "document/document_error.h"
#include "model/algebra/numbers.h"

namespace rigfit::model {

/// A scene that cannot be used; `what()` is the whole message, with file, line, key and remedy.
using SceneError = document::DocumentError;

inline constexpr double kStandardGravity = 9.80665;  // m/s^2, ISO 80000-3

/// Stiffness of an elastic support; infinity: fixed, zero: free.
struct Support {
  /// What kind it is; the keys of the scene file.
  enum class Kind { free, pinned, clamped, elastic };
  Kind kind = Kind::free;
  Vector3d translational = Vector3d::Zero();  ///< N/m along x, y, z (elastic only)
  Vector3d rotational = Vector3d::Zero();     ///< N m/rad about x, y, z (elastic only)
};

/// A point where members end.
struct SceneNode {
  std::string name;
  Vector3d position = Vector3d::Zero();  ///< m
  Support support;
  double mass = 0;  ///< kg (sensor, clamp)
};

/// Viscous joint dampers in parallel with the springs, as sections (per unit strain or curvature
/// rate): a joint of a segment of length l has the damper `bending / l`, as its spring is EI / l.
struct JointDamping {
  double axial = 0;    ///< N s
  double bending = 0;  ///< N m^2 s
  double torsion = 0;  ///< N m^2 s
};

/// A mass clamped to a member between its ends (sensor, U-bolt).
struct AttachedMass {
  double position = 0;  ///< 0..1 of the unstretched length
  double mass = 0;      ///< kg
};

/// A cable or a beam between two nodes.
struct Member {
  /// What kind it is; the keys of the scene file.
  enum class Kind { cable, beam };
  /// Whether rigid ends are stress-free at the equilibrium or along the straight line.
  enum class Assembled { hanging, straight };
  /// The length that a mass per length refers to (actual_state.h); unsaid: the unstretched one.
  enum class MassOf { unsaid, unstretched, installed };
  /// How a member meets a free node.
  enum class Joint { rigid, pinned };

  std::string name;
  Kind kind = Kind::cable;
  std::array<std::string, 2> nodes;
  int segments = 0;            ///< 0: "auto" by the scene's accuracy
  double mass_per_length = 0;  ///< kg/m at the first node
  MassOf mass_of = MassOf::unsaid;
  double EA = 0;  ///< N
  /// N m^2 about z (in-plane bending), about the horizontal in-plane axis.
  std::array<double, 2> EI{0, 0};
  double GJ = 0;             ///< N m^2
  double polar_inertia = 0;  ///< kg m, about the axis per length; 0: torsion without inertia
  /// Diameter at the second node over that at the first, linear between: mass and EA go with its
  /// square, EI, GJ and polar inertia with its fourth power. 1: prismatic.
  double taper = 1;

  // A cable's initial state: exactly one of these (a beam: none, it is stress-free as drawn).
  std::optional<double> tension;             ///< N, horizontal component in the sagged equilibrium
  std::optional<double> unstretched_length;  ///< m
  std::optional<double> stretch;  ///< m, end displacement from the unstretched straight cable

  double thermal_expansion = 0;  ///< 1/K, of a cable's unstretched length

  Assembled assembled = Assembled::hanging;
  std::array<Joint, 2> joint{Joint::rigid, Joint::rigid};  ///< at each end
  std::optional<double> damping_ratio;                     ///< modal; exclusive with joint dampers
  JointDamping damping;
  std::vector<AttachedMass> masses;
};

/// A place in the scene: a node, or a position along a member (0..1 of the unstretched length).
struct Place {
  std::string node;    ///< empty: on a member
  std::string member;  ///< empty: at a node
  double position = 0;
};

/// A force on the rig, or a mass released from it.
struct Load {
  /// What kind it is; the keys of the scene file.
  enum class Kind { impact, release, record };
  std::string name;
  Kind kind = Kind::impact;
  Place place;
  Vector3d direction{0, -1, 0};  ///< unit vector
  double peak = 0;               ///< N (impact)
  double duration = 0;           ///< s (impact, half-sine)
  double start = 0;              ///< s (impact)
  double mass = 0;               ///< kg (release: hung there, released at t = 0)
  std::string file;  ///< record: CSV of time, force; resolved against the scene's folder
};

/// A point and a direction at which a quantity is read.
struct Sensor {
  /// Quantity along the sensor's direction; `force` is the axial force of the member.
  enum class Quantity { acceleration, velocity, displacement, force };
  std::string name;
  Place place;
  Vector3d direction{0, 1, 0};  ///< unit vector
  Quantity quantity = Quantity::acceleration;
};

/// The load cell on which the cables' tensions were read.
struct LoadCell {
  double scale = 1;
  double zero = 0;  ///< N
  /// True tension for a reading, N.
  [[nodiscard]] double tension(double reading) const { return scale * reading + zero; }
};

/// A rig: nodes, members, loads and sensors.
struct Scene {
  std::string title;
  std::string file;                           ///< where it was read from, empty: made in memory
  Vector3d gravity{0, -kStandardGravity, 0};  ///< m/s^2
  double accuracy = 1e-4;  ///< relative error in frequency that "auto" segments and the choice of
                           ///< solver must keep
  LoadCell load_cell;
  double temperature_change = 0;  ///< K, since the cables' lengths were measured
  std::vector<SceneNode> nodes;
  std::vector<Member> members;
  std::vector<Load> loads;
  std::vector<Sensor> sensors;
};

}  // namespace rigfit::model
