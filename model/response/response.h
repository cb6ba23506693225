// The time response of a scene, by the solver that the scene needs: one call.
//
// The linear answer comes first; from it the shift of frequencies by the size of the motion is
// estimated (nonlinearity.h). Within the scene's accuracy the exact
// modal response is the answer; beyond it the equations are integrated as they are, in the plane
// when nothing pushes the scene out of it: explicitly unless that would take many times the work of
// the stiff scheme or cannot be had of the scene (joint dampers that overdamp waves, torsion, nodes
// that turn in space). Only the motions that a load drives are
// looked at; axial waves are slowed (explicit_motion.h) where the estimate of what that costs
// allows it; members that say "auto" get the segments that bring the error of frequencies below the
// scene's accuracy. Every choice can be forced, and what was left out is listed with its estimated
// cost (response_estimates.h).
//
// A hung mass acts as mass x |gravity| along the load's direction, and is gone at t = 0. Sensors:
// displacements from the unloaded equilibrium, force the axial force (static part included).
#pragma once

#include <optional>
#include <string>
#include <vector>

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
[[nodiscard]] const char* name_of(ResponseSolver solver);

/// What time history is wanted, and what is forced of the choices above.
struct ResponseOptions {
  SamplingOptions sampling;
  ResponseSolver solver = ResponseSolver::automatic;
  std::optional<bool> plane;    ///< move in the plane of symmetry only; else by need
  std::optional<bool> torsion;  ///< model it or not; else by need
  /// Axial waves as they are, or not: the modal solver then lets modes along the members follow
  /// at once, explicit steps slow them as far as one step a sample needs. Else by estimate.
  std::optional<bool> axial;
  std::optional<int> segments;   ///< overrides every member's number
  std::optional<double> step_s;  ///< largest step of the explicit scheme
  /// Local, of the stiff scheme; else a thousandth of the scene's accuracy.
  std::optional<double> relative_tolerance;
  std::vector<ForceHistory> records;  ///< by load of the scene; used for kind `record`
  /// Number of modes of each motion in the linear answer; 0: all up to 400 unknowns a motion, else
  /// the lowest 200.
  int modes = 0;
  /// Estimate the error by the number of segments also where none says "auto" (as long again).
  bool resolution_estimate = false;
};

/// The time history, and how it was found.
struct ResponseResult {
  Equilibrium equilibrium;  ///< look at `status` first: nothing else is set unless it converged
  bool completed = false;
  bool impossible = false;  ///< what was asked for cannot be had of this scene
  std::string reason;       ///< for a person, when not completed
  /// Estimated error of samples that were forced to be linear while the motion is not: the phase
  /// that the shift of frequencies runs up over half of the duration; else 0.
  double linear_error = 0;
  std::string told;  ///< why a scheme slower than the explicit one was taken; or empty

  double rate_hz = 0;
  std::vector<std::string> sensors;  ///< names
  Eigen::MatrixXd samples;           ///< rows (0, 1/rate, ...) x sensors

  ResponseSolver solver = ResponseSolver::modal;
  bool nonlinear = false;           ///< whether the estimated shift exceeds the scene's accuracy
  double frequency_shift = 0;       ///< estimated, relative
  double frequency_at_rest_hz = 0;  ///< frequency of the mode with most of the energy
  double frequency_moving_hz = 0;   ///< its estimate in motion
  std::string motion;               ///< "plane" or "space"
  int unknowns = 0;
  long steps = 0;
  double step_s = 0;
  double wall_s = 0;  ///< from the scene to the samples; what is estimated after that not counted
  double energy_drift = 0;
  std::vector<int> segments;  ///< by member
  /// Relative error of frequencies, weighted by energy; negative: not asked for.
  double resolution_error = -1;
  EnergyBalance energy;
  std::vector<std::string> members;  ///< names
  std::vector<std::string> kept;
  std::vector<LeftOut> left_out;
};

/// Never throws for physics. Throws SceneError for a record load without its history.
[[nodiscard]] ResponseResult simulate_response(const Scene& scene, const ResponseOptions& options);

}  // namespace rigfit::model
