#include "apps/results/modal_files.h"

#include <cctype>
#include <cmath>
#include <numbers>

#include "signal/writers/write_uff.h"

namespace rigfit::apps {
namespace {

/// UFF's direction (1 x, 2 y, 3 z, with sign) of a unit vector along an axis; 0 for any other.
int uff_direction(const Eigen::Vector3d& direction) {
  for (int k = 0; k < 3; ++k) {
    if (std::abs(std::abs(direction[k]) - 1) < 1e-9) return direction[k] > 0 ? k + 1 : -(k + 1);
  }
  return 0;
}

/// The scene's sensors, then its loads, and the nodes of their places: each once, numbered in this
/// order.
std::vector<signal::MeasuredPoint> points_of(const model::Scene& scene,
                                             std::vector<signal::NodePosition>& nodes) {
  std::vector<signal::MeasuredPoint> points;
  const auto add = [&](const auto& all) {
    for (const auto& one : all) {
      const Eigen::Vector3d at = position_of(scene, one.place);
      auto node = std::ranges::find_if(nodes, [&](const auto& known) {
        return (Eigen::Vector3d(known.position_m.data()) - at).norm() < 1e-9;
      });
      if (node == nodes.end()) {
        node = nodes.insert(node, {static_cast<int>(nodes.size()) + 1, {at[0], at[1], at[2]}});
      }
      points.push_back({one.name, node->node, uff_direction(one.direction)});
    }
  };
  add(scene.sensors);
  add(scene.loads);
  return points;
}

}  // namespace

std::string file_word(std::string label) {
  std::erase_if(label, [](unsigned char c) { return !std::isalnum(c) && c != '.' && c != '-'; });
  return label.empty() ? "state" : label;
}

signal::MeasuredPoint uff_point(const model::Scene& scene, const std::string& name,
                                const std::string& shown_name) {
  std::vector<signal::NodePosition> nodes;
  const auto points = points_of(scene, nodes);
  const auto at = std::ranges::find(points, name, &signal::MeasuredPoint::name);
  if (at == points.end()) return {shown_name, 0, 0};
  return {shown_name, at->node, at->direction};
}

std::string mode_file(const model::Scene* scene, const signal::ModalModel& modes) {
  std::vector<signal::NodePosition> nodes;
  if (scene) (void)points_of(*scene, nodes);
  return signal::uff_text(modes, nodes);
}

}  // namespace rigfit::apps
