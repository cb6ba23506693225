// Computes the time response of a scene by a solver chosen for it.
//
// The linear response is computed first, and from it the shift of frequencies with amplitude is
// estimated (response_modes.h). If the shift is within the scene's accuracy, the exact modal
// response is returned. Otherwise the non-linear equations are integrated, in the plane when
// nothing pushes the scene out of it, by the explicit scheme or, where that cannot handle the scene
// (joint dampers, torsion, nodes that turn in space), by the stiff one. Only motions that a load
// drives are computed; axial waves are slowed (explicit_motion.h) where the estimated error allows
// it; "auto" members get enough segments to keep the error of frequencies below the scene's
// accuracy. Every choice can be forced, and effects left out are listed with their estimated error
// (response_modes.h).
//
// A hung mass acts as mass x |gravity| along the load's direction and is removed at t = 0. Sensors
// read displacements from the unloaded equilibrium, or the axial force with its static part.
#pragma once

#include "model/algebra/numbers.h"
#include "model/motion/sampling.h"
#include "model/scene/force_history.h"
#include "model/scene/left_out.h"
#include "model/scene/scene.h"
#include "model/statics/equilibrium_result.h"

namespace rigfit::model {

/// How the equations of motion are solved.
enum class ResponseSolver {
  automatic,
  modal,            ///< linear, exact
  explicit_motion,  ///< explicit_motion.h
  stiff_motion,     ///< stiff_motion.h
};
/// The word in JSON, such as "modal".
[[nodiscard]] constexpr const char* name_of(ResponseSolver solver) {
  constexpr const char* kNames[] = {"auto", "modal", "explicit", "stiff"};
  return kNames[static_cast<std::size_t>(solver)];
}

/// Sampling of the time history, and choices above that are forced.
struct ResponseOptions {
  SamplingOptions sampling;
  ResponseSolver solver = ResponseSolver::automatic;
  bool space = false;  ///< motion in space also where nothing pushes the scene out of its plane
  /// Whether the explicit scheme resolves axial waves. If not, it slows them until one step per
  /// sample is stable. Empty: decided by the estimated error.
  std::optional<bool> axial;
  std::optional<int> segments;   ///< overrides every member's number
  std::optional<double> step_s;  ///< largest step of the explicit scheme
  /// Local tolerance of the stiff scheme; empty: a thousandth of the scene's accuracy.
  std::optional<double> relative_tolerance;
  std::vector<ForceHistory> records;  ///< by load of the scene; used for kind `record`
  /// Also estimate the error due to segments where no member is "auto" (doubles the time).
  bool resolution_estimate = false;
};

/// The time history, and how it was computed.
struct ResponseResult : MotionOutput {
  Equilibrium equilibrium;  ///< check `status` first: the rest is set only if it converged
  bool impossible = false;  ///< the scene does not allow the options
  /// Estimated error of a linear solution forced on a non-linear motion: the phase error due to the
  /// shift of frequencies over half of the duration; else 0.
  double linear_error = 0;
  std::string told;  ///< why a scheme slower than the explicit one was used; or empty

  double rate_hz = 0;
  std::vector<std::string> sensors;  ///< names

  ResponseSolver solver = ResponseSolver::modal;
  bool nonlinear = false;           ///< whether the estimated shift exceeds the scene's accuracy
  double frequency_shift = 0;       ///< estimated, relative
  double frequency_at_rest_hz = 0;  ///< frequency of the mode with most of the energy
  double frequency_moving_hz = 0;   ///< its estimate in motion
  std::string motion;               ///< "plane" or "space"
  int unknowns = 0;
  double wall_s = 0;          ///< time to compute the samples, s; later estimates not counted
  double energy_drift = 0;    ///< 0 for the modal solver, whose samples are exact
  std::vector<int> segments;  ///< by member
  /// Relative error of frequencies, weighted by energy; negative: not estimated.
  double resolution_error = -1;
  std::vector<std::string> members;  ///< names
  std::vector<std::string> kept;
  std::vector<LeftOut> left_out;

  static constexpr auto fields() {
    using T = ResponseResult;
    return std::tuple{
        field("solver", &T::solver, "", "solver", ""),
        field("solver_reason", &T::told),
        field("nonlinear", &T::nonlinear, "", "non-linear", "the shift exceeds the accuracy asked"),
        field("frequency_shift", &T::frequency_shift, "%", "shift of frequencies",
              "by the motion, estimated", 2),
        field("frequency_at_rest_hz", &T::frequency_at_rest_hz, "Hz", "frequency at rest",
              "of the mode with most of the energy", 5),
        field("frequency_moving_hz", &T::frequency_moving_hz, "Hz", "frequency in motion", "", 5),
        field("", &T::motion, "", "motion", ""),
        field("", &T::unknowns, "", "unknowns", ""),
        field("steps", &T::steps, "", "steps", ""),
        field("step_s", &T::step_s),
        field("wall_s", &T::wall_s, "s", "time", "to compute the samples", 3),
        field("energy_drift", &T::energy_drift, "", "energy drift", "", 2),
        field("sample_rate_hz", &T::rate_hz),
        field("", &T::left_out, "", "left out", "")};
  }
};

/// Throws SceneError for a record load without its history. Failures to compute a response are
/// reported in the result.
[[nodiscard]] ResponseResult simulate_response(const Scene& scene, const ResponseOptions& options);

}  // namespace rigfit::model
