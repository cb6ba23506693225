// From a scene to its static equilibrium and natural modes, in one call: the way in for every user
// of the model who does not want to see the chain inside.
//
// Undamped modes are (K - omega^2 M) phi = 0 about the equilibrium, mass-normalised; K is the
// tangent with gravity, tension and curvature in it. Damped modes solve the quadratic problem with
// the joint dampers' C, or carry the members' modal ratios weighted by strain energy.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/scene/scene.h"

namespace rigfit::model {

enum class EquilibriumStatus { converged, slack, buckled, mechanism, not_converged };
[[nodiscard]] const char* name_of(EquilibriumStatus status);

struct MemberEquilibrium {
  std::string member;
  double sag_m = 0;          ///< largest distance from the chord
  double tension_N = 0;      ///< horizontal component (mean axial force of a beam)
  double tension_max_N = 0;  ///< along the member
  double unstretched_length_m = 0;
  int segments = 0;
  Eigen::Matrix3Xd positions;  ///< m, 3 x (segments + 1), from the first node to the second
};

struct Equilibrium {
  EquilibriumStatus status = EquilibriumStatus::not_converged;
  std::string reason;   ///< for a person, when not converged
  double residual = 0;  ///< largest unbalanced force over the largest member force
  int iterations = 0;
  std::vector<MemberEquilibrium> members;
};

/// How segments are lumped. rigid_rod is the paper's: rotary inertia m l^2/12 about a transverse
/// axis, joints of EI / l, half a segment at a clamp; frequencies err by l^2. Accurate takes the
/// inertia and the joints for which they err by l^4, tension and clamps included
/// (segment_lumping.h).
enum class RotaryInertia { accurate, rigid_rod };

enum class ModePlane { in, out, mixed, axial, torsion };
enum class ModeFamily { cable, beam, hybrid };
[[nodiscard]] const char* name_of(ModePlane plane);
[[nodiscard]] const char* name_of(ModeFamily family);

struct ModeShape {
  std::string member;
  Eigen::Matrix3Xd displacement;  ///< 3 x (segments + 1), mass-normalised, kg^-1/2
  Eigen::VectorXd twist;          ///< segments; empty when torsion is not modelled
};

struct NaturalMode {
  double frequency_hz = 0;  ///< undamped
  /// Richardson's value for vanishing segments, from three numbers of segments; the frequency
  /// itself when no error estimate was asked for.
  double extrapolated_hz = 0;
  double damping_ratio = 0;
  ModePlane plane = ModePlane::in;
  ModeFamily family = ModeFamily::cable;
  std::vector<double> kinetic_energy;  ///< fraction by member, in the scene's order; sums to one
                                       ///< less that of node masses
  std::vector<ModeShape> shape;        ///< by member
  Eigen::VectorXd
      sensor_shape;  ///< modal displacement at each of the scene's sensors along its direction;
                     ///< of a force sensor the change of axial force, N kg^-1/2
  Eigen::VectorXd load_shape;  ///< the same at each of the scene's loads
};

struct ModesOptions {
  int count = 6;                                     ///< first N, ignored when a band is given
  std::optional<std::pair<double, double>> band_hz;  ///< all modes inside
  RotaryInertia rotary_inertia = RotaryInertia::accurate;
  bool damped = true;          ///< damping ratios too
  bool shapes = true;          ///< false: frequencies, planes and sensors only
  bool error_estimate = true;  ///< two finer chains too: 3.5 times the time again
  /// `in` or `out`: only the motion in or out of the plane of symmetry, where the scene has one;
  /// `count` is then of its modes. Others: both.
  std::optional<ModePlane> plane;
  std::optional<int> segments;  ///< overrides every member's number
  std::optional<bool> torsion;  ///< force modelling it or not; else by need
};

struct LeftOut {
  std::string what;           ///< such as "torsion"
  double relative_error = 0;  ///< estimated
  /// What the error is of: "frequency" (of the modes that take part), or "response" (root mean
  /// square of the sensors' samples).
  std::string of = "frequency";
};

struct ModalAnalysis {
  Equilibrium equilibrium;
  std::vector<NaturalMode>
      modes;  ///< by rising frequency, planes found separately where the scene has them
  double relative_error_estimate = 0;  ///< of the asked frequencies, from the number of segments
  bool complete = false;  ///< a Sturm count proves that no mode in the range was missed
  int unknowns = 0;
  std::vector<LeftOut>
      left_out;  ///< "modelled" in the document says what was kept and what was not
  std::vector<std::string> kept;
};

/// Never throws for physics: see `equilibrium.status`; modes are empty unless it is converged.
[[nodiscard]] ModalAnalysis analyse_modes(const Scene& scene, const ModesOptions& options = {});

/// A number of the scene by name: "<member>.EI" (".EI_z", ".EI_y" for one of two), ".EA", ".GJ",
/// ".mass_per_length", ".tension", ".unstretched_length", ".stretch", ".taper", ".damping_ratio",
/// ".damping_axial", ".damping_bending", ".damping_torsion", "<node>.mass", "<node>.x|.y|.z",
/// "<node>.translational_x|_y|_z", "<node>.rotational_x|_y|_z", "<load>.mass", "<load>.peak",
/// "<load>.position" (0..1, on a member), "<load>.direction_x|_y|_z" (turns the unit vector).
/// Both throw SceneError naming the parameters there are when the name is unknown.
[[nodiscard]] double parameter(const Scene& scene, const std::string& name);
void set_parameter(Scene& scene, const std::string& name, double value);
[[nodiscard]] std::vector<std::string> parameter_names(const Scene& scene);

struct ModeSensitivities {
  ModalAnalysis analysis;
  Eigen::MatrixXd
      frequency;  ///< modes x parameters: d frequency_hz / d p, the change of equilibrium included
  Eigen::MatrixXd damping_ratio;              ///< modes x parameters
  std::vector<Eigen::MatrixXd> sensor_shape;  ///< per parameter: sensors x modes
};

[[nodiscard]] ModeSensitivities analyse_mode_sensitivities(
    const Scene& scene, const std::vector<std::string>& parameters,
    const ModesOptions& options = {});

}  // namespace rigfit::model
