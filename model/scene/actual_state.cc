#include "model/scene/actual_state.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "model/scene/scene_error.h"

namespace rigfit::model {
namespace {

double distance(const Scene& scene, const Member& member) {
  const auto at = [&](const std::string& name) {
    const auto node = std::find_if(scene.nodes.begin(), scene.nodes.end(),
                                   [&](const SceneNode& one) { return one.name == name; });
    return node == scene.nodes.end() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : node->position;
  };
  return (at(member.nodes[1]) - at(member.nodes[0])).norm();
}

}  // namespace

bool is_actual(const Scene& scene) {
  return scene.load_cell.scale == 1 && scene.load_cell.zero == 0 && scene.temperature_change == 0;
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
    if (stretch == 1) continue;
    if (member.unstretched_length) *member.unstretched_length *= stretch;
    if (member.stretch) {
      const double chord = distance(scene, member);
      member.stretch = chord - (chord - *member.stretch) * stretch;
    }
  }
  return actual;
}

}  // namespace rigfit::model
