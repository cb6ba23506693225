// Computes a scene's static equilibrium and natural modes in one call: the entry point for users
// who do not need the chain itself.
//
// Undamped modes are (K - omega^2 M) phi = 0 about the equilibrium, mass-normalised; K is the
// tangent with gravity, tension and curvature in it. Damped modes solve the quadratic problem with
// the joint dampers' C, or carry the members' modal ratios weighted by strain energy.
#pragma once

#include "model/algebra/numbers.h"
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
      modes;  ///< by rising frequency; planes of a symmetric scene are solved separately
  double relative_error_estimate = 0;  ///< error of the frequencies due to the number of segments
  /// True if an accuracy was given, or every member has "auto" segments: `frequency_hz` is then
  /// extrapolated to vanishing segments (segment_extrapolation.h); shapes,
  /// damping, equilibrium and sensitivities belong to the finest chain.
  bool extrapolated = false;
  bool complete = false;  ///< a Sturm count proves that no mode in the range was missed
  int unknowns = 0;
  std::vector<LeftOut>
      left_out;  ///< effects left out; with `kept` this is "modelled" in the document
  std::vector<std::string> kept;
};

/// Does not throw when no equilibrium is found: check `equilibrium.status`; `modes` are then empty.
[[nodiscard]] ModalAnalysis analyse_modes(const Scene& scene, const ModesOptions& options = {});

struct ResolvedModes;
/// What `resolved` says to a user, without `left_out` and `kept`; `options` says whether damping
/// ratios and shapes are wanted. A mode is of a plane or a family when at least 0.9 of its kinetic
/// energy is; twist and motion along the members count from 0.5.
[[nodiscard]] ModalAnalysis analysis_of(const ResolvedModes& resolved, const Scene& scene,
                                        const ModesOptions& options);

/// Modes and their derivatives by the given parameters.
struct ModeSensitivities {
  ModalAnalysis analysis;
  MatrixXd
      frequency;  ///< modes x parameters: d frequency_hz / d p, the change of equilibrium included
  MatrixXd damping_ratio;  ///< modes x parameters
};

/// Modes and their derivatives by `parameters`; zero unless the equilibrium converged.
[[nodiscard]] ModeSensitivities mode_sensitivities_by(
    const Scene& scene, const std::vector<ParameterAccess>& parameters,
    const ModesOptions& options = {});
/// The same by name, as in parameters.h; throws SceneError for an unknown one.
[[nodiscard]] inline ModeSensitivities analyse_mode_sensitivities(
    const Scene& scene, const std::vector<std::string>& parameters,
    const ModesOptions& options = {}) {
  return mode_sensitivities_by(scene, parameters_named(scene, parameters), options);
}

}  // namespace rigfit::model
