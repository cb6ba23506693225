// Modes and FRFs of a report as universal files, for other programs: points of the scene as
// dataset 15, shapes as 55, FRFs as 58.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <string>

#include "model/scene/scene.h"
#include "signal/modes/modal_model.h"

namespace rigfit::apps {

/// The scene's sensor or load called `name` as a UFF point called `shown_name`. UFF nodes number
/// the places of sensors and loads from 1, each once, in the scene's order; an unknown name gets 0.
[[nodiscard]] signal::MeasuredPoint uff_point(const model::Scene& scene, const std::string& name,
                                              const std::string& shown_name);

/// Identified modes, at the scene's sensors where there is a scene (else null).
[[nodiscard]] std::string mode_file(const model::Scene* scene, const signal::ModalModel& modes);

/// A label as a part of a file's name: "200 N" -> "200N".
[[nodiscard]] std::string file_word(std::string label);

/// Where a sensor or load of the scene is, m, along straight members.
[[nodiscard]] inline Eigen::Vector3d position_of(const model::Scene& scene,
                                                 const model::Place& place) {
  const auto node = [&](const std::string& name) -> Eigen::Vector3d {
    const auto at = std::ranges::find(scene.nodes, name, &model::SceneNode::name);
    return at == scene.nodes.end() ? Eigen::Vector3d(0, 0, 0) : at->position;
  };
  const auto member = std::ranges::find(scene.members, place.member, &model::Member::name);
  if (!place.node.empty() || member == scene.members.end()) return node(place.node);
  const Eigen::Vector3d from = node(member->nodes[0]), to = node(member->nodes[1]);
  return from + place.position * (to - from);
}

}  // namespace rigfit::apps
