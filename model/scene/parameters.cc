#include "model/scene/parameters.h"

#include <algorithm>
#include <cmath>

#include "model/scene/scene_error.h"

namespace rigfit::model {
namespace {

template <class Get>
ParameterAccess access(std::string name, std::string unit, Get reference) {
  return {std::move(name), std::move(unit),
          [reference](const Scene& scene) { return double(reference(const_cast<Scene&>(scene))); },
          [reference](Scene& scene, double value) { reference(scene) = value; }};
}

const ParameterAccess* find(const std::vector<ParameterAccess>& all, const std::string& name) {
  for (const auto& one : all) {
    if (one.name == name) return &one;
  }
  return nullptr;
}

[[noreturn]] void unknown(const Scene& scene, const std::string& name) {
  std::string known;
  for (const auto& other : parameter_names(scene)) known += (known.empty() ? "" : ", ") + other;
  throw SceneError({scene.file, 0, 0, name}, "the scene has no parameter \"" + name + "\"",
                   "use one of: " + known);
}

}  // namespace

std::vector<ParameterAccess> scene_parameters(const Scene& scene) {
  std::vector<ParameterAccess> all;
  for (std::size_t m = 0; m < scene.members.size(); ++m) {
    const Member& member = scene.members[m];
    const std::string& n = member.name;
    if (member.EI[0] == member.EI[1]) {
      // One number for both axes.
      all.push_back({n + ".EI", "N m2", [m](const Scene& s) { return s.members[m].EI[0]; },
                     [m](Scene& s, double v) {
                       s.members[m].EI = {v, v};
                     }});
    }
    all.push_back(
        access(n + ".EI_z", "N m2", [m](Scene& s) -> double& { return s.members[m].EI[0]; }));
    all.push_back(
        access(n + ".EI_y", "N m2", [m](Scene& s) -> double& { return s.members[m].EI[1]; }));
    all.push_back(access(n + ".EA", "N", [m](Scene& s) -> double& { return s.members[m].EA; }));
    all.push_back(access(n + ".GJ", "N m2", [m](Scene& s) -> double& { return s.members[m].GJ; }));
    all.push_back(access(n + ".mass_per_length", "kg/m",
                         [m](Scene& s) -> double& { return s.members[m].mass_per_length; }));
    all.push_back(access(n + ".polar_inertia", "kg m",
                         [m](Scene& s) -> double& { return s.members[m].polar_inertia; }));
    all.push_back(
        access(n + ".taper", "", [m](Scene& s) -> double& { return s.members[m].taper; }));
    if (member.tension) {
      all.push_back(
          access(n + ".tension", "N", [m](Scene& s) -> double& { return *s.members[m].tension; }));
    }
    if (member.unstretched_length) {
      all.push_back(access(n + ".unstretched_length", "m",
                           [m](Scene& s) -> double& { return *s.members[m].unstretched_length; }));
    }
    if (member.stretch) {
      all.push_back(
          access(n + ".stretch", "m", [m](Scene& s) -> double& { return *s.members[m].stretch; }));
    }
    if (member.thermal_expansion != 0) {
      all.push_back(access(n + ".thermal_expansion", "1/K",
                           [m](Scene& s) -> double& { return s.members[m].thermal_expansion; }));
    }
    if (member.damping_ratio) {
      all.push_back(access(n + ".damping_ratio", "",
                           [m](Scene& s) -> double& { return *s.members[m].damping_ratio; }));
    } else {
      all.push_back(access(n + ".damping_axial", "N s",
                           [m](Scene& s) -> double& { return s.members[m].damping.axial; }));
      all.push_back(access(n + ".damping_bending", "N m2 s",
                           [m](Scene& s) -> double& { return s.members[m].damping.bending; }));
      all.push_back(access(n + ".damping_torsion", "N m2 s",
                           [m](Scene& s) -> double& { return s.members[m].damping.torsion; }));
    }
    for (std::size_t k = 0; k < member.masses.size(); ++k) {
      const std::string prefix = n + ".masses" + std::to_string(k + 1);
      all.push_back(access(prefix + ".mass", "kg",
                           [m, k](Scene& s) -> double& { return s.members[m].masses[k].mass; }));
      all.push_back(access(prefix + ".position", "", [m, k](Scene& s) -> double& {
        return s.members[m].masses[k].position;
      }));
    }
  }
  const char* axis_name[] = {"x", "y", "z"};
  for (std::size_t k = 0; k < scene.nodes.size(); ++k) {
    const SceneNode& node = scene.nodes[k];
    all.push_back(
        access(node.name + ".mass", "kg", [k](Scene& s) -> double& { return s.nodes[k].mass; }));
    for (int axis = 0; axis < 3; ++axis) {
      all.push_back(access(node.name + "." + axis_name[axis], "m",
                           [k, axis](Scene& s) -> double& { return s.nodes[k].position[axis]; }));
    }
    if (node.support.kind != Support::Kind::elastic) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (std::isfinite(node.support.translational[axis])) {
        all.push_back(access(
            node.name + ".translational_" + axis_name[axis], "N/m",
            [k, axis](Scene& s) -> double& { return s.nodes[k].support.translational[axis]; }));
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      if (std::isfinite(node.support.rotational[axis])) {
        all.push_back(
            access(node.name + ".rotational_" + axis_name[axis], "N m/rad",
                   [k, axis](Scene& s) -> double& { return s.nodes[k].support.rotational[axis]; }));
      }
    }
  }
  for (std::size_t k = 0; k < scene.loads.size(); ++k) {
    const Load& load = scene.loads[k];
    if (load.kind == Load::Kind::release) {
      all.push_back(
          access(load.name + ".mass", "kg", [k](Scene& s) -> double& { return s.loads[k].mass; }));
    }
    if (load.kind == Load::Kind::impact) {
      all.push_back(
          access(load.name + ".peak", "N", [k](Scene& s) -> double& { return s.loads[k].peak; }));
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
                       Eigen::Vector3d& direction = s.loads[k].direction;
                       direction[axis] = v;
                       if (direction.norm() > 0) direction.normalize();
                     }});
    }
  }
  const auto any = [&](auto holds) {
    return std::any_of(scene.members.begin(), scene.members.end(), holds);
  };
  if (any([](const Member& m) { return m.tension.has_value(); })) {
    all.push_back(
        access("load_cell.scale", "", [](Scene& s) -> double& { return s.load_cell.scale; }));
    all.push_back(
        access("load_cell.zero", "N", [](Scene& s) -> double& { return s.load_cell.zero; }));
  }
  if (any([](const Member& m) { return m.thermal_expansion != 0; })) {
    all.push_back(access("temperature_change", "K",
                         [](Scene& s) -> double& { return s.temperature_change; }));
  }
  return all;
}

std::vector<ParameterAccess> parameters_named(const Scene& scene,
                                              const std::vector<std::string>& names) {
  const auto all = scene_parameters(scene);
  std::vector<ParameterAccess> chosen;
  for (const std::string& name : names) {
    const auto* one = find(all, name);
    if (!one) unknown(scene, name);
    chosen.push_back(*one);
  }
  return chosen;
}

double parameter(const Scene& scene, const std::string& name) {
  const auto all = scene_parameters(scene);
  if (const auto* one = find(all, name)) return one->get(scene);
  unknown(scene, name);
}

void set_parameter(Scene& scene, const std::string& name, double value) {
  const auto all = scene_parameters(scene);
  if (const auto* one = find(all, name)) return one->set(scene, value);
  unknown(scene, name);
}

std::vector<std::string> parameter_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const auto& one : scene_parameters(scene)) names.push_back(one.name);
  return names;
}

}  // namespace rigfit::model
