// From a scene to its static equilibrium and natural modes, in one call: the entry point for every
// user of the model who does not need to see the chain inside.
//
// Undamped modes are (K - omega^2 M) phi = 0 about the equilibrium, mass-normalised; K is the
// tangent with gravity, tension and curvature in it. Damped modes solve the quadratic problem with
// the joint dampers' C, or carry the members' modal ratios weighted by strain energy.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/linear/natural_mode.h"
#include "model/scene/left_out.h"
#include "model/scene/parameters.h"
#include "model/scene/scene.h"
#include "model/statics/equilibrium_result.h"

namespace rigfit::model {

/// Equilibrium and natural modes of a scene.
struct ModalAnalysis {
  Equilibrium equilibrium;
  std::vector<NaturalMode>
      modes;  ///< by rising frequency, planes found separately where the scene has them
  double relative_error_estimate = 0;  ///< error of the asked frequencies by the number of segments
  /// True if an accuracy was asked for, or every member left its segments to the program:
  /// `frequency_hz` are then extrapolated to vanishing segments (segment_extrapolation.h); shapes,
  /// damping, equilibrium and sensitivities belong to the finest chain.
  bool extrapolated = false;
  bool complete = false;  ///< a Sturm count proves that no mode in the range was missed
  int unknowns = 0;
  std::vector<LeftOut>
      left_out;  ///< "modelled" in the document says what was kept and what was not
  std::vector<std::string> kept;
};

/// Never throws for physics: see `equilibrium.status`; modes are empty unless it is converged.
[[nodiscard]] ModalAnalysis analyse_modes(const Scene& scene, const ModesOptions& options = {});

/// Modes and their derivatives by the parameters asked for.
struct ModeSensitivities {
  ModalAnalysis analysis;
  Eigen::MatrixXd
      frequency;  ///< modes x parameters: d frequency_hz / d p, the change of equilibrium included
  Eigen::MatrixXd damping_ratio;              ///< modes x parameters
  std::vector<Eigen::MatrixXd> sensor_shape;  ///< per parameter: sensors x modes
};

/// Modes and their derivatives by `parameters` (names as in parameters.h). The derivatives are
/// empty unless the equilibrium converged; throws SceneError for an unknown name.
[[nodiscard]] ModeSensitivities analyse_mode_sensitivities(
    const Scene& scene, const std::vector<std::string>& parameters,
    const ModesOptions& options = {});

}  // namespace rigfit::model
