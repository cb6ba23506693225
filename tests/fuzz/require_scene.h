// What the scene reader owes for any bytes: a scene of finite values that its own text reads back
// to, or a SceneError with a reason and a remedy.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>

#include "model/linear/modal_analysis.h"
#include "model/scene/read_scene.h"

namespace rigfit::model {

/// Throws std::logic_error when a scene breaks what its reader promises.
inline void require_sound(const Scene& scene) {
  const auto require = [](bool good, const char* what) {
    if (!good) throw std::logic_error(what);
  };
  require(!scene.members.empty(), "a scene without members");
  require(scene.gravity.allFinite(), "gravity");
  require(scene.accuracy > 0 && scene.accuracy <= 0.1, "accuracy");
  for (const auto& node : scene.nodes) {
    require(!node.name.empty() && node.position.allFinite(), "node");
    require(std::isfinite(node.mass) && node.mass >= 0, "mass of a node");
  }
  for (const auto& member : scene.members) {
    require(!member.name.empty() && member.segments >= 0, "member");
    for (const double positive : {member.mass_per_length, member.EA, member.taper}) {
      require(std::isfinite(positive) && positive > 0, "a member's property");
    }
    for (const double value : {member.EI[0], member.EI[1], member.GJ, member.polar_inertia}) {
      require(std::isfinite(value) && value >= 0, "a member's stiffness");
    }
  }
  for (const auto& load : scene.loads) {
    require(std::abs(load.direction.norm() - 1) < 1e-9, "direction of a load");
  }
  for (const auto& sensor : scene.sensors) {
    require(std::abs(sensor.direction.norm() - 1) < 1e-9, "direction of a sensor");
  }
  const std::string text = scene_text(scene);
  std::string again;
  try {
    again = scene_text(parse_scene(text, scene.file));
  } catch (const SceneError& error) {
    throw std::logic_error("its own text is refused: " + std::string(error.what()));
  }
  require(again == text, "its own text reads back to another scene");
}

/// A SceneError is fine when it says something.
template <typename Read>
void read_or_refuse(Read&& read) {
  try {
    read();
  } catch (const SceneError& error) {
    if (error.problem().empty() || error.remedy().empty()) {
      throw std::logic_error("a refusal without a reason or a remedy");
    }
  }
}

inline void require_scene_or_reason(std::string_view bytes) {
  read_or_refuse([&] { require_sound(parse_scene(bytes, "fuzz")); });
}

}  // namespace rigfit::model
