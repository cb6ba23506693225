// A natural mode of a scene, and the options of modal analysis.
#pragma once

#include <tuple>

#include "document/describe.h"
#include "model/algebra/numbers.h"
#include "model/chain/segment_lumping.h"

namespace rigfit::model {

/// The plane or kind of motion of a mode; the plane of symmetry is "in".
enum class ModePlane { in, out, mixed, axial, torsion };
/// Whether cables or beams carry the kinetic energy.
enum class ModeFamily { cable, beam, hybrid };
/// The word in JSON, such as "out".
[[nodiscard]] constexpr const char* name_of(ModePlane plane) {
  constexpr const char* kNames[] = {"in", "out", "mixed", "axial", "torsion"};
  return kNames[static_cast<std::size_t>(plane)];
}
/// The word in JSON, such as "hybrid".
[[nodiscard]] constexpr const char* name_of(ModeFamily family) {
  constexpr const char* kNames[] = {"cable", "beam", "hybrid"};
  return kNames[static_cast<std::size_t>(family)];
}

/// The shape of a mode on one member.
struct ModeShape {
  std::string member;
  Matrix3Xd displacement;  ///< 3 x (segments + 1), mass-normalised, kg^-1/2
  VectorXd twist;          ///< segments; empty when torsion is not modelled

  static constexpr auto fields() {
    using T = ModeShape;
    return std::tuple{
        field("member", &T::member),
        field("displacement", [](const T& s) { return MatrixXd(s.displacement.transpose()); }),
        field("twist", &T::twist)};
  }
};

/// One natural mode.
struct NaturalMode {
  double frequency_hz = 0;  ///< undamped
  /// Frequency extrapolated to vanishing segments, from three numbers of segments, or from one more
  /// than `frequency_hz` where that is extrapolated itself. Equal to `frequency_hz` without an
  /// error estimate.
  double extrapolated_hz = 0;
  double damping_ratio = 0;
  ModePlane plane = ModePlane::in;
  ModeFamily family = ModeFamily::cable;
  describe::ByName kinetic_energy;  ///< fraction by member, in the scene's order; sums to one less
                                    ///< that of node masses
  std::vector<ModeShape> shape;     ///< by member
  VectorXd sensor_shape;            ///< modal displacement at each of the scene's sensors along its
                          ///< direction; at a force sensor the change of axial force, N kg^-1/2
  VectorXd load_shape;  ///< modal displacement at each of the scene's loads, likewise

  static constexpr auto fields() {
    using T = NaturalMode;
    return std::tuple{
        field("frequency_hz", &T::frequency_hz, "Hz", "frequency", "undamped", 7),
        field("damping_ratio", &T::damping_ratio, "%", "damping", "", 4),
        field("plane", &T::plane, "", "plane", "in, out, mixed, axial or torsion"),
        field("family", &T::family, "", "family", "cable, beam or hybrid"),
        field("kinetic_energy", &T::kinetic_energy, "", "kinetic energy", "by member"),
        field("extrapolated_hz", &T::extrapolated_hz)};
  }
};

/// Which modes are computed, and with which model.
struct ModesOptions {
  int count = 6;                                     ///< first N, ignored when a band is given
  std::optional<std::pair<double, double>> band_hz;  ///< all modes inside
  RotaryInertia rotary_inertia = RotaryInertia::accurate;
  bool damped = true;          ///< also compute damping ratios
  bool shapes = true;          ///< false: frequencies, planes and sensors only
  bool error_estimate = true;  ///< solves two finer chains as well, for 3.5 times the time
  /// In place of `count`, where the scene has a plane of symmetry: modes of the motion in it and of
  /// that out of it.
  std::optional<std::array<int, 2>> by_plane;
  std::optional<int> segments;  ///< overrides every member's number
  /// Relative accuracy of frequencies, which are extrapolated to vanishing segments; numbers of
  /// segments are then ignored. `relative_error_estimate` gives the remaining error.
  std::optional<double> accuracy;
  std::optional<bool> torsion;  ///< whether to model torsion; empty: if needed
};

}  // namespace rigfit::model
