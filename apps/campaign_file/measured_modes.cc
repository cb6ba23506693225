#include "apps/campaign_file/measured_modes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include <fstream>
#include <map>
#include "apps/results/modal_files.h"
#include "apps/results/text_table.h"
#include "model/scene/scene_error.h"
#include "signal/numerics/numbers.h"
#include "signal/readers/read_recording.h"
#include "signal/readers/uff/read_uff_modes.h"

namespace rigfit::apps {
namespace {

using signal::kNaN;

[[noreturn]] void fail(const TextTable& table, long line, const std::string& key,
                       const std::string& problem, const std::string& remedy) {
  throw model::SceneError({table.file, line, 0, key}, problem, remedy);
}

/// Throws unless there is a column of frequencies, and every column of shapes is of a sensor.
void check(const TextTable& table, const std::string& frequency,
           const std::vector<std::string>& sensors) {
  std::vector<std::string> names;
  for (const auto& column : table.columns) names.push_back(column.name);
  if (table.find(frequency) < 0) {
    fail(table, table.header_line, frequency, "there is no such column",
         fmt::format("name the column of the frequencies with --column; there are: {}",
                     fmt::join(names, ", ")));
  }
  for (const auto& name : names) {
    if (!name.starts_with("shape:") ||
        std::find(sensors.begin(), sensors.end(), name.substr(6)) != sensors.end()) {
      continue;
    }
    fail(table, table.header_line, name, "the scene has no such sensor",
         sensors.empty() ? "add one to the scene"
                         : fmt::format("there are: {}", fmt::join(sensors, ", ")));
  }
}

}  // namespace

std::vector<MeasuredTableRow> read_measured_modes(const std::filesystem::path& path,
                                                  const std::string& column,
                                                  std::optional<model::ModePlane> plane,
                                                  const std::vector<std::string>& sensors) {
  const TextTable table = read_text_table(path);
  const std::string frequency = column.empty() ? "frequency_hz" : column;
  check(table, frequency, sensors);
  std::vector<MeasuredTableRow> rows;
  for (const auto& line : table.rows) {
    const auto positive = [&](const std::string& name) {
      const double value = table.number(line, name);
      if (value <= 0) {
        fail(table, line.line, name, "\"" + table.text(line, name) + "\" is no positive number",
             "correct it, or leave the cell blank");
      }
      return value;
    };
    MeasuredTableRow row;
    row.mode.frequency_hz.value = positive(frequency);
    if (!std::isfinite(row.mode.frequency_hz.value)) continue;  // a dash: not measured
    row.mode.frequency_hz.std = kNaN;
    for (const char* name : {"frequency_std", "frequency_std_hz", "std_hz", "std"}) {
      if (const double std = positive(name); !std::isnan(std)) row.mode.frequency_hz.std = std;
    }
    row.mode.damping_ratio.value = positive("damping_ratio");
    if (row.mode.damping_ratio.value >= 1) {
      fail(table, line.line, "damping_ratio", "is not below 1",
           "give it as a fraction, not percent");
    }
    row.mode.damping_ratio.std = positive("damping_std");
    row.mode.plane = plane;
    const std::string word = table.text(line, "plane");
    if (word == "in") {
      row.mode.plane = model::ModePlane::in;
    } else if (word == "out") {
      row.mode.plane = model::ModePlane::out;
    } else if (!word.empty()) {
      fail(table, line.line, "plane", "\"" + word + "\" is no plane",
           "write in, out, or leave it blank");
    }
    const double order = positive("order");
    if (std::isfinite(order)) {
      if (order != std::round(order) || order > 200) {
        fail(table, line.line, "order", "is no whole number of 1 to 200",
             "1 is the first mode of its plane");
      }
      row.mode.order = static_cast<int>(order);
    }
    const double tension = positive("tension_N");
    if (std::isfinite(tension)) row.tension_N = tension;
    Eigen::VectorXcd shape(static_cast<Eigen::Index>(sensors.size()));
    bool whole = !sensors.empty();
    for (std::size_t s = 0; s < sensors.size(); ++s) {
      const double component = table.number(line, "shape:" + sensors[s]);
      whole = whole && std::isfinite(component);
      shape[static_cast<Eigen::Index>(s)] = component;
    }
    if (whole) row.mode.shape = shape;
    rows.push_back(std::move(row));
  }
  if (rows.empty())
    fail(table, 0, frequency, "no mode is listed", "one line a mode below the names");
  return rows;
}

namespace {

/// Share of the scene's extent within which a node is where a sensor is: what people measure a rig
/// to, and far more than what six printed digits lose.
constexpr double kSamePlace = 1e-3;

/// The file's node of each sensor, in the file's own axes; empty where a sensor has none, and `why`
/// says so.
std::vector<int> nodes_of_sensors(const model::Scene& scene, const signal::UffModes& file,
                                  std::string& why) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(INFINITY), high = -low;
  for (const auto& node : scene.nodes) {
    low = low.cwiseMin(node.position), high = high.cwiseMax(node.position);
  }
  const double reach = scene.nodes.empty() ? 0 : kSamePlace * (high - low).norm();
  std::vector<int> nodes;
  for (const auto& sensor : scene.sensors) {
    const Eigen::Vector3d at = position_of(scene, sensor.place);
    const signal::UffNode* nearest = nullptr;
    double distance = reach;
    for (const auto& one : file.nodes) {
      const double apart = (Eigen::Vector3d(one.position_m.data()) - at).norm();
      if (apart <= distance) distance = apart, nearest = &one;
    }
    if (nearest == nullptr || nearest->displacement_system > 1) {
      why = fmt::format("sensor {} at ({:.4g}, {:.4g}, {:.4g}) m {}", sensor.name, at[0], at[1],
                        at[2],
                        nearest ? "is at a node with axes of its own: write the file in those of "
                                  "the scene"
                                : "has no node within a thousandth of the rig: write the nodes' "
                                  "coordinates (dataset 15 or 2411) in the scene's axes");
      return {};
    }
    nodes.push_back(nearest->node);
  }
  return nodes;
}

}  // namespace

bool is_universal_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string head(1024, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
  return signal::format_of(head) == signal::RecordingFormat::uff;
}

std::vector<MeasuredTableRow> measured_modes(const std::string& path, const std::string& column,
                                             std::optional<model::ModePlane> plane,
                                             const model::Scene& scene, VerbContext& context) {
  context.input(path);
  if (!is_universal_file(path)) {
    std::vector<std::string> sensors;
    for (const auto& sensor : scene.sensors) sensors.push_back(sensor.name);
    return read_measured_modes(path, column, plane, sensors);
  }
  if (!column.empty()) throw UsageError(path + " is a universal file: --column is of tables");
  const signal::UffModes file = signal::read_uff_modes(path);
  std::vector<std::string> remarks = file.remarks;
  std::string why;
  const auto nodes = nodes_of_sensors(scene, file, why);
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
      const auto one = at.find(nodes[s]);
      whole = one != at.end();
      if (!whole) break;
      std::complex<double> moves = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        moves +=
            scene.sensors[s].direction[static_cast<Eigen::Index>(k)] * one->second->translation[k];
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
  for (const auto& remark : remarks) context.warn("universal_file", remark, path);
  return rows;
}

}  // namespace rigfit::apps
