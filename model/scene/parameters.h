// Access to the numbers of a scene by name, for fits and sensitivities.
#pragma once

#include <functional>
#include <string_view>

#include "model/algebra/numbers.h"
#include "model/scene/scene.h"

namespace rigfit::model {

/// Value of the number with this name: "<member>.EI" (".EI_z", ".EI_y" for one of two), ".EA",
/// ".GJ",
/// ".mass_per_length", ".tension", ".unstretched_length", ".stretch", ".taper", ".damping_ratio",
/// ".damping_axial", ".damping_bending", ".damping_torsion", "<node>.mass", "<node>.x|.y|.z",
/// "<node>.translational_x|_y|_z", "<node>.rotational_x|_y|_z", "<load>.mass", "<load>.peak",
/// "<load>.position" (0..1, on a member), "<load>.direction_x|_y|_z" (turns the unit vector);
/// "load_cell.scale", "load_cell.zero" where a cable has a tension; "<member>.thermal_expansion",
/// "temperature_change" where a cable expands (actual_state.h).
/// Throws SceneError, which lists the scene's parameters, when the name is unknown.
[[nodiscard]] double parameter(const Scene& scene, const std::string& name);
/// Sets the number with this name; throws SceneError like `parameter`.
void set_parameter(Scene& scene, const std::string& name, double value);
/// Names of all parameters of the scene.
[[nodiscard]] std::vector<std::string> parameter_names(const Scene& scene);

/// What the last part of a parameter's name means, such as "axial stiffness EA" for "EA"; empty:
/// not known.
[[nodiscard]] std::string quantity_words(std::string_view quantity);

/// A parameter's name and unit, and how it is read and set.
struct ParameterAccess {
  std::string name;
  std::string unit;
  std::function<double(const Scene&)> get;
  std::function<void(Scene&, double)> set;
};

/// Every parameter the scene has, members first, in the scene's order.
[[nodiscard]] std::vector<ParameterAccess> scene_parameters(const Scene& scene);
/// The parameters with these names, in their order; throws SceneError for an unknown name.
[[nodiscard]] std::vector<ParameterAccess> parameters_named(const Scene& scene,
                                                            const std::vector<std::string>& names);
/// One parameter for several that change together, each by its factor over the first's: the value
/// of the first, which moves the others from where they are.
[[nodiscard]] ParameterAccess moved_together(const std::vector<ParameterAccess>& parameters,
                                             const std::vector<double>& factors);

}  // namespace rigfit::model
