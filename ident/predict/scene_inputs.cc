#include "ident/predict/scene_inputs.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/scene/parameters.h"

namespace rigfit::ident {

std::vector<AddedInput> add_scene_inputs(const model::Scene& scene,
                                         const std::vector<SceneInput>& inputs,
                                         FittedParameters& fitted) {
  std::vector<AddedInput> added;
  added.reserve(inputs.size());
  const auto of_fit = static_cast<Eigen::Index>(fitted.parameters.size());
  for (const auto& input : inputs) {
    AddedInput one{input.name, input.value.value_or(model::parameter(scene, input.name)),
                   input.std};
    if (input.relative) one.std *= std::abs(one.value);
    if (!(one.std > 0) || !std::isfinite(one.std) || !std::isfinite(one.value)) {
      throw std::invalid_argument("the uncertainty of " + input.name + " is not positive");
    }
    for (const auto& parameter : fitted.parameters) {
      const auto& targets = parameter.targets;
      one.fitted = one.fitted || parameter.name == input.name ||
                   std::find(targets.begin(), targets.end(), input.name) != targets.end();
    }
    if (!one.fitted) {
      const auto n = static_cast<Eigen::Index>(fitted.parameters.size());
      fitted.parameters.push_back({input.name, one.value});
      fitted.covariance.conservativeResize(n + 1, n + 1);
      fitted.covariance.row(n).setZero();
      fitted.covariance.col(n).setZero();
      fitted.covariance(n, n) = one.std * one.std;
      for (const auto& effect : fitted.inputs) {
        if (effect.name != input.name) continue;
        one.of_fit = true;
        fitted.covariance.col(n).head(of_fit) = one.std * effect.change.head(of_fit);
        fitted.covariance.row(n) = fitted.covariance.col(n).transpose();
      }
    }
    added.push_back(one);
  }
  return added;
}

}  // namespace rigfit::ident
