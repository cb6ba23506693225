// Transfers results of earlier tests to the scene of a test: EI at the tension of a state, EA and
// the damping ratio of an axial test, each with its uncertainty.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ident/stiffness/stiffness_curve.h"
#include "ident/update/problem/update_data.h"
#include "model/scene/scene.h"

namespace rigfit::ident {

struct KnownValues {
  StiffnessCurve EI;                     ///< empty: no bending test
  signal::Estimate EA_N, damping_ratio;  ///< from the axial test; NaN: none
};

/// A scene and its parameters (such as "cable.EI") that take a state's tension and known values.
struct SceneUse {
  model::Scene scene;
  std::vector<std::string> tension_of, EI_of, EA_of, damping_of;
};

/// The scene that stands for the rig at a tension (empty: as built). Throws model::SceneError for a
/// parameter that the scene does not have.
[[nodiscard]] model::Scene scene_at(const SceneUse& use, const KnownValues& known,
                                    std::optional<double> tension_N);

/// State `state` of a fit, at that tension.
struct StateUse {
  int state = 0;
  SceneUse use;
  std::optional<double> tension_N;
};

/// Uncertainties of EI, EA and damping in these states, as inputs of a fit: each source (of EI,
/// each term of the curve's uncertainty) moves all states together.
[[nodiscard]] std::vector<UncertainInput> known_inputs(const KnownValues& known,
                                                       const std::vector<StateUse>& states);

}  // namespace rigfit::ident
