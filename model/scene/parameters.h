// The numbers of a scene by name, for fits and sensitivities: see modal_analysis.h for the names
// and for `parameter`, `set_parameter`, `parameter_names`.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "model/scene/scene.h"

namespace rigfit::model {

struct ParameterAccess {
  std::string name;
  std::string unit;
  std::function<double(const Scene&)> get;
  std::function<void(Scene&, double)> set;
};

/// Every parameter the scene has, members first, in the scene's order.
[[nodiscard]] std::vector<ParameterAccess> scene_parameters(const Scene& scene);
/// Those of the given names, in their order; throws SceneError for an unknown one.
[[nodiscard]] std::vector<ParameterAccess> parameters_named(const Scene& scene,
                                                            const std::vector<std::string>& names);

}  // namespace rigfit::model
