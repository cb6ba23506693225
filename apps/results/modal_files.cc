#include "apps/results/modal_files.h"

#include <cctype>
#include <cmath>
#include <numbers>

#include "signal/writers/write_uff.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;

/// UFF's direction (1 x, 2 y, 3 z, with sign) of a unit vector along an axis; 0 for any other.
int uff_direction(const Eigen::Vector3d& direction) {
  for (int k = 0; k < 3; ++k) {
    if (std::abs(std::abs(direction[k]) - 1) < 1e-9) return direction[k] > 0 ? k + 1 : -(k + 1);
  }
  return 0;
}

/// The node of a place; a new one where none is near.
int node_at(const Eigen::Vector3d& at, std::vector<signal::NodePosition>& nodes) {
  for (const auto& known : nodes) {
    if ((Eigen::Vector3d(known.position_m.data()) - at).norm() < 1e-9) return known.node;
  }
  nodes.push_back({static_cast<int>(nodes.size()) + 1, {at[0], at[1], at[2]}});
  return nodes.back().node;
}

/// Every place of a sensor or load once, numbered in the scene's order.
std::vector<signal::NodePosition> nodes_of(const model::Scene& scene) {
  std::vector<signal::NodePosition> nodes;
  for (const auto& sensor : scene.sensors) node_at(position_of(scene, sensor.place), nodes);
  for (const auto& load : scene.loads) node_at(position_of(scene, load.place), nodes);
  return nodes;
}

}  // namespace

std::string file_word(const std::string& label) {
  std::string word;
  for (const char c : label) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-';
    if (plain) word += c;
  }
  return word.empty() ? "state" : word;
}

signal::MeasuredPoint uff_point(const model::Scene& scene, const std::string& name,
                                const std::string& shown_name) {
  signal::MeasuredPoint point{shown_name, 0, 0};
  auto nodes = nodes_of(scene);
  const auto look = [&](const auto& all) {
    for (const auto& one : all) {
      if (one.name != name || point.node > 0) continue;
      point = {shown_name, node_at(position_of(scene, one.place), nodes),
               uff_direction(one.direction)};
    }
  };
  look(scene.sensors);
  look(scene.loads);
  return point;
}

std::string mode_file(const model::Scene* scene, const signal::ModalModel& modes) {
  return scene ? signal::uff_text(modes, nodes_of(*scene)) : signal::uff_text(modes);
}

}  // namespace rigfit::apps
