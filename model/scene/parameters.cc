#include "model/scene/parameters.h"

#include <fmt/ranges.h>

#include <tuple>

#include "model/scene/scene_numbers.h"

namespace rigfit::model {
std::vector<ParameterAccess> scene_parameters(const Scene& scene) {
  std::vector<ParameterAccess> all;
  const auto add = [&](std::string name, const char* unit, auto reference) {
    all.push_back({std::move(name), unit,
                   [reference](const Scene& s) { return reference(const_cast<Scene&>(s)); },
                   [reference](Scene& s, double value) { reference(s) = value; }});
  };
  for (std::size_t m = 0; m < scene.members.size(); ++m) {
    Member member = scene.members[m];
    const std::string own = member.name + ".";
    if (member.EI[0] == member.EI[1]) {
      // One number for both axes.
      all.push_back({own + "EI", "N m2", [m](const Scene& s) { return s.members[m].EI[0]; },
                     [m](Scene& s, double v) {
                       s.members[m].EI = {v, v};
                     }});
    }
    for (const std::size_t axis : {0, 1}) {
      add(own + (axis == 0 ? "EI_z" : "EI_y"), "N m2",
          [m, axis](Scene& s) -> double& { return s.members[m].EI[axis]; });
    }
    for (const auto& one : kMemberNumbers) {
      // What is not given cannot be found; a cable that does not expand has no temperature.
      const double* value = one.of(member);
      if (!value || (value == &member.thermal_expansion && *value == 0)) continue;
      add(own + one.key, one.unit,
          [m, &one](Scene& s) -> double& { return *one.of(s.members[m]); });
    }
    for (const auto& one : kDampingNumbers) {
      if (member.damping_ratio) break;
      add(own + "damping_" + one.key, one.unit,
          [m, &one](Scene& s) -> double& { return *one.of(s.members[m].damping); });
    }
    for (std::size_t k = 0; k < member.masses.size(); ++k) {
      const std::string prefix = own + "masses" + std::to_string(k + 1);
      add(prefix + ".mass", "kg",
          [m, k](Scene& s) -> double& { return s.members[m].masses[k].mass; });
      add(prefix + ".position", "",
          [m, k](Scene& s) -> double& { return s.members[m].masses[k].position; });
    }
  }
  const std::string axis_name[] = {"x", "y", "z"};
  for (std::size_t k = 0; k < scene.nodes.size(); ++k) {
    const SceneNode& node = scene.nodes[k];
    add(node.name + ".mass", "kg", [k](Scene& s) -> double& { return s.nodes[k].mass; });
    for (int axis = 0; axis < 3; ++axis) {
      add(node.name + "." + axis_name[axis], "m",
          [k, axis](Scene& s) -> double& { return s.nodes[k].position[axis]; });
    }
    if (node.support.kind != Support::Kind::elastic) continue;
    for (const auto& [words, unit, stiffness] :
         {std::tuple{".translational_", "N/m", &Support::translational},
          std::tuple{".rotational_", "N m/rad", &Support::rotational}}) {
      for (int axis = 0; axis < 3; ++axis) {
        if (!std::isfinite((node.support.*stiffness)[axis])) continue;
        add(node.name + words + axis_name[axis], unit,
            [k, axis, part = stiffness](Scene& s) -> double& {
              return (s.nodes[k].support.*part)[axis];
            });
      }
    }
  }
  for (std::size_t k = 0; k < scene.loads.size(); ++k) {
    const Load& load = scene.loads[k];
    if (load.kind == Load::Kind::release) {
      add(load.name + ".mass", "kg", [k](Scene& s) -> double& { return s.loads[k].mass; });
    }
    if (load.kind == Load::Kind::impact) {
      add(load.name + ".peak", "N", [k](Scene& s) -> double& { return s.loads[k].peak; });
    }
    if (load.place.node.empty()) {
      // Beyond the member's end there is nothing to strike.
      all.push_back(
          {load.name + ".position", "", [k](const Scene& s) { return s.loads[k].place.position; },
           [k](Scene& s, double v) { s.loads[k].place.position = std::clamp(v, 0.0, 1.0); }});
    }
    for (int axis = 0; axis < 3; ++axis) {
      // A direction stays a unit vector: moving a component turns it.
      all.push_back({load.name + ".direction_" + axis_name[axis], "",
                     [k, axis](const Scene& s) { return s.loads[k].direction[axis]; },
                     [k, axis](Scene& s, double v) {
                       Vector3d& direction = s.loads[k].direction;
                       direction[axis] = v;
                       if (direction.norm() > 0) direction.normalize();
                     }});
    }
  }
  const auto any = [&](auto holds) {
    return std::any_of(scene.members.begin(), scene.members.end(), holds);
  };
  if (any([](const Member& m) { return m.tension.has_value(); })) {
    add("load_cell.scale", "", [](Scene& s) -> double& { return s.load_cell.scale; });
    add("load_cell.zero", "N", [](Scene& s) -> double& { return s.load_cell.zero; });
  }
  if (any([](const Member& m) { return m.thermal_expansion != 0; })) {
    add("temperature_change", "K", [](Scene& s) -> double& { return s.temperature_change; });
  }
  return all;
}

std::string quantity_words(std::string_view quantity) {
  for (const auto& one : kMemberNumbers) {
    if (quantity == one.key) return one.words;
  }
  for (const auto& one : kDampingNumbers) {
    if (quantity == std::string("damping_") + one.key) return one.words;
  }
  if (quantity == "EI" || quantity == "EI_z" || quantity == "EI_y") {
    return "bending stiffness " + std::string(quantity);
  }
  if (quantity == "mass") return "mass";
  if (quantity == "peak") return "peak force";
  if (quantity == "position") return "position along the member";
  const std::string axis(1, quantity.empty() ? ' ' : quantity.back());
  const std::string_view along = quantity.substr(0, std::max<std::size_t>(quantity.size(), 1) - 1);
  if (axis != "x" && axis != "y" && axis != "z") return "";
  if (along.empty()) return "position " + axis;
  if (along == "direction_") return "direction " + axis;
  if (along == "translational_") return "support stiffness k_" + axis;
  if (along == "rotational_") return "support stiffness about " + axis;
  return "";
}

std::vector<ParameterAccess> parameters_named(const Scene& scene,
                                              const std::vector<std::string>& names) {
  const auto all = scene_parameters(scene);
  std::vector<ParameterAccess> chosen;
  for (const std::string& name : names) {
    const auto one = std::ranges::find(all, name, &ParameterAccess::name);
    if (one == all.end()) {
      throw SceneError({scene.file, 0, 0, name}, "the scene has no parameter \"" + name + "\"",
                       fmt::format("use one of: {}", fmt::join(parameter_names(scene), ", ")));
    }
    chosen.push_back(*one);
  }
  return chosen;
}

ParameterAccess moved_together(const std::vector<ParameterAccess>& parameters,
                               const std::vector<double>& factors) {
  ParameterAccess out = parameters.front();
  out.set = [parameters, factors](Scene& scene, double value) {
    const double by = (value - parameters[0].get(scene)) / factors[0];
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      parameters[k].set(scene, parameters[k].get(scene) + by * factors[k]);
    }
  };
  return out;
}

double parameter(const Scene& scene, const std::string& name) {
  return parameters_named(scene, {name}).front().get(scene);
}

void set_parameter(Scene& scene, const std::string& name, double value) {
  parameters_named(scene, {name}).front().set(scene, value);
}

std::vector<std::string> parameter_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const auto& one : scene_parameters(scene)) names.push_back(one.name);
  return names;
}

}  // namespace rigfit::model
