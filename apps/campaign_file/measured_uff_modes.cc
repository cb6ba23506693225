#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <stdexcept>

#include "apps/campaign_file/measured_modes.h"
#include "apps/results/modal_files.h"
#include "signal/numerics/numbers.h"
#include "signal/readers/read_recording.h"
#include "signal/readers/uff/read_uff_modes.h"

namespace rigfit::apps {
namespace {

struct SensorNode {
  int node = 0;
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
};

/// Share of the scene's extent within which a node is where a sensor is: what people measure a rig
/// to, and far more than what six printed digits lose.
constexpr double kSamePlace = 1e-3;

class SensorNodes {
 public:
  SensorNodes(const model::Scene& scene, const signal::UffModes& file,
              const std::vector<NodeOfSensor>& named)
      : scene_(scene), file_(file), named_(named) {
    Eigen::Vector3d low = Eigen::Vector3d::Constant(INFINITY), high = -low;
    for (const auto& node : scene.nodes) {
      low = low.cwiseMin(node.position), high = high.cwiseMax(node.position);
    }
    reach_ = scene.nodes.empty() ? 0 : kSamePlace * (high - low).norm();
  }

  /// One for each sensor; empty where a sensor has none, and `why` says so.
  std::vector<SensorNode> find(std::string& why) const {
    std::vector<SensorNode> nodes;
    for (const auto& sensor : scene_.sensors) {
      const auto named = std::find_if(named_.begin(), named_.end(),
                                      [&](const auto& n) { return n.sensor == sensor.name; });
      SensorNode node;
      if (named != named_.end()) {
        node = {named->node, sensor.direction};
        if (named->direction != 0) {
          node.along.setZero();
          node.along[std::abs(named->direction) - 1] = named->direction > 0 ? 1 : -1;
        } else if (own_axes(named->node)) {
          why = fmt::format("node {} has axes of its own: write {}={}+X (or Y, Z, with sign)",
                            named->node, sensor.name, named->node);
          return {};
        }
      } else {
        const Eigen::Vector3d at = position_of(scene_, sensor.place);
        const signal::UffNode* nearest = nullptr;
        double distance = reach_;
        for (const auto& one : file_.nodes) {
          const double apart = (Eigen::Vector3d(one.position_m.data()) - at).norm();
          if (apart <= distance) distance = apart, nearest = &one;
        }
        if (nearest == nullptr || own_axes(nearest->node)) {
          why = fmt::format(
              "sensor {} at ({:.4g}, {:.4g}, {:.4g}) m {}: name its node with --node {}=NUMBER",
              sensor.name, at[0], at[1], at[2],
              nearest ? "is at a node with axes of its own" : "has no node within a thousandth",
              sensor.name);
          return {};
        }
        node = {nearest->node, sensor.direction};
      }
      nodes.push_back(node);
    }
    return nodes;
  }

 private:
  bool own_axes(int node) const {
    return std::any_of(file_.nodes.begin(), file_.nodes.end(), [&](const auto& one) {
      return one.node == node && one.displacement_system > 1;
    });
  }

  const model::Scene& scene_;
  const signal::UffModes& file_;
  const std::vector<NodeOfSensor>& named_;
  double reach_ = 0;
};

}  // namespace

bool is_universal_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string head(1024, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
  return signal::format_of(head) == signal::RecordingFormat::uff;
}

NodeOfSensor node_of_sensor(const std::string& text) {
  NodeOfSensor out;
  const auto equals = text.rfind('=');
  const auto fail = [&] {
    return std::invalid_argument("\"" + text + "\": write SENSOR=NODE or SENSOR=NODE+X");
  };
  if (equals == std::string::npos || equals == 0) throw fail();
  out.sensor = text.substr(0, equals);
  const char* last = text.data() + text.size();
  const auto [end, problem] = std::from_chars(text.data() + equals + 1, last, out.node);
  if (problem != std::errc()) throw fail();
  if (end == last) return out;
  const std::string_view axes = "XYZ";
  const auto axis = axes.find(static_cast<char>(last[-1] & ~0x20));
  if (last - end != 2 || (*end != '+' && *end != '-') || axis == std::string_view::npos) {
    throw fail();
  }
  out.direction = (*end == '-' ? -1 : 1) * (static_cast<int>(axis) + 1);
  return out;
}

std::vector<MeasuredTableRow> read_uff_measured_modes(const std::filesystem::path& path,
                                                      std::optional<model::ModePlane> plane,
                                                      const model::Scene& scene,
                                                      const std::vector<NodeOfSensor>& named,
                                                      std::vector<std::string>& remarks) {
  const signal::UffModes file = signal::read_uff_modes(path);
  remarks.insert(remarks.end(), file.remarks.begin(), file.remarks.end());
  std::string why;
  const auto nodes = SensorNodes(scene, file, named).find(why);
  if (!why.empty()) remarks.push_back("shapes are not used: " + why);
  std::vector<MeasuredTableRow> rows;
  int absent = 0;
  for (const auto& found : file.modes) {
    MeasuredTableRow row;
    row.mode.frequency_hz = {found.frequency_hz, signal::kNaN};
    // A ratio that is not positive is none of a mode; it is not fitted.
    row.mode.damping_ratio = {found.damping_ratio > 0 ? found.damping_ratio : signal::kNaN,
                              signal::kNaN};
    row.mode.plane = plane;
    std::map<int, const signal::UffNodeShape*> at;
    for (const auto& one : found.shape) at.emplace(one.node, &one);
    Eigen::VectorXcd shape(static_cast<Eigen::Index>(nodes.size()));
    bool whole = !nodes.empty() && !found.shape.empty();
    for (std::size_t s = 0; s < nodes.size() && whole; ++s) {
      const auto one = at.find(nodes[s].node);
      whole = one != at.end();
      if (!whole) break;
      std::complex<double> moves = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        moves += nodes[s].along[static_cast<Eigen::Index>(k)] * one->second->translation[k];
      }
      shape[static_cast<Eigen::Index>(s)] = moves;
    }
    whole = whole && shape.squaredNorm() > 0;
    absent += !whole && !nodes.empty();
    if (whole) row.mode.shape = shape;
    rows.push_back(std::move(row));
  }
  if (absent > 0) {
    remarks.push_back(
        fmt::format("{} of {} modes come without a shape at every sensor", absent, rows.size()));
  }
  return rows;
}

}  // namespace rigfit::apps
