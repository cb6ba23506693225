// Inputs of a scene that are known to an uncertainty, beside the parameters of a fit: a tip mass, a
// length, a mass per length that the prediction would otherwise take as exact.
//
// With p the fit's parameters and x the scene's inputs the joint covariance is
//
//   cov(p, p) = C,   cov(x, x) = s^2,   cov(p, x) = change s
//
// where `change` is by how much p moves with one standard uncertainty of the input in the fit, if
// the fit had an input of that name (it is then the same quantity, and what C holds of it counts
// once), else 0. An input that the fit found as a parameter keeps the fit's value and covariance.
// Source: GUM (JCGM 100:2008), 5.2.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ident/predict/scene_prediction.h"
#include "model/scene/scene.h"

namespace rigfit::ident {

struct SceneInput {
  std::string name;                  ///< a parameter of the scene
  std::optional<double> value = {};  ///< not given: the scene's own
  double std = 0;                    ///< > 0
  bool relative = false;             ///< `std` is relative to the value
};

struct AddedInput {
  std::string name;
  double value = 0, std = 0;
  bool of_fit = false;  ///< an input of the fit as well
  bool fitted = false;  ///< a parameter of the fit: not added
};

/// Adds the inputs to `fitted` as parameters. Throws model::SceneError for a name that the scene
/// does not have, std::invalid_argument for an uncertainty that is not positive and finite.
std::vector<AddedInput> add_scene_inputs(const model::Scene& scene,
                                         const std::vector<SceneInput>& inputs,
                                         FittedParameters& fitted);

}  // namespace rigfit::ident
