#include "model/scene/actual_state.h"

#include <fmt/format.h>

namespace rigfit::model {

Vector3d chord_of(const Scene& scene, const Member& member) {
  Vector3d along = Vector3d::Zero();
  for (const SceneNode& node : scene.nodes) {
    if (node.name == member.nodes[0]) along -= node.position;
    if (node.name == member.nodes[1]) along += node.position;
  }
  return along;
}

double installed_strain(const Scene& scene, const Member& member) {
  if (member.kind == Member::Kind::beam) return 0;
  if (member.tension) return *member.tension / member.EA;
  const double chord = chord_of(scene, member).norm();
  if (member.stretch) return *member.stretch / (chord - *member.stretch);
  return member.unstretched_length ? std::max(0.0, chord / *member.unstretched_length - 1) : 0;
}

double undecided_mass(const Scene& scene) {
  constexpr double kUnnoticed = 0.005;  // a quarter of a per cent of a frequency
  double largest = 0;
  for (const Member& member : scene.members) {
    if (member.mass_of == Member::MassOf::unsaid) {
      largest = std::max(largest, installed_strain(scene, member));
    }
  }
  return largest > kUnnoticed ? largest : 0;
}

bool is_actual(const Scene& scene) {
  return std::none_of(scene.members.begin(), scene.members.end(),
                      [](const Member& m) { return m.mass_of == Member::MassOf::installed; }) &&
         scene.load_cell.scale == 1 && scene.load_cell.zero == 0 && scene.temperature_change == 0;
}

Scene actual_state(const Scene& scene) {
  Scene actual = scene;
  actual.load_cell = {};
  actual.temperature_change = 0;
  for (Member& member : actual.members) {
    if (member.tension) {
      const double reading = *member.tension;
      member.tension = scene.load_cell.tension(reading);
      if (!(*member.tension > 0)) {
        throw SceneError(
            {scene.file, 0, 0, "load_cell"},
            fmt::format("makes {} N of the {} N of \"{}\"", *member.tension, reading, member.name),
            "tension = scale x reading + zero must be positive");
      }
    }
    const double stretch = 1 + member.thermal_expansion * scene.temperature_change;
    if (member.unstretched_length) *member.unstretched_length *= stretch;
    if (member.stretch && stretch != 1) {
      const double chord = chord_of(scene, member).norm();
      member.stretch = chord - (chord - *member.stretch) * stretch;
    }
    if (member.mass_of == Member::MassOf::installed) {
      member.mass_per_length *= 1 + installed_strain(actual, member);
      member.mass_of = Member::MassOf::unstretched;
    }
  }
  return actual;
}

}  // namespace rigfit::model
