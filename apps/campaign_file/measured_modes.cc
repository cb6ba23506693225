#include "apps/campaign_file/measured_modes.h"

#include <Eigen/Geometry>

#include "apps/results/text_table.h"
#include "model/scene/scene.h"
#include "signal/numerics/numbers.h"
#include "signal/readers/read_recording.h"

namespace rigfit::apps {
namespace {

using signal::kNaN;

/// Throws unless every column of shapes is of a sensor.
void check_shapes(const TextTable& table, const std::vector<std::string>& sensors) {
  for (const auto& column : table.columns) {
    const std::string& name = column.name;
    if (!name.starts_with("shape:") || std::ranges::count(sensors, name.substr(6)) > 0) continue;
    throw model::SceneError(
        {table.file, table.header_line, 0, name}, "the scene has no such sensor",
        sensors.empty() ? "add one to the scene"
                        : fmt::format("there are: {}", fmt::join(sensors, ", ")));
  }
}

/// Share of the scene's extent within which a node is where a sensor is: what people measure a rig
/// to, and far more than what six printed digits lose.
constexpr double kSamePlace = 1e-3;

/// The file's node of each sensor, in the file's own axes; empty where a sensor has none, and `why`
/// says so.
std::vector<int> nodes_of_sensors(const model::Scene& scene, const signal::UffModes& file,
                                  std::string& why) {
  Eigen::AlignedBox3d rig;
  for (const auto& node : scene.nodes) rig.extend(node.position);
  const double reach = rig.isEmpty() ? 0 : kSamePlace * rig.diagonal().norm();
  std::vector<int> nodes;
  for (const auto& sensor : scene.sensors) {
    const Eigen::Vector3d at = position_of(scene, sensor.place);
    auto nearest = file.nodes.end();
    double distance = reach;
    for (auto one = file.nodes.begin(); one != file.nodes.end(); ++one) {
      const double apart = (Eigen::Vector3d(one->second.position_m.data()) - at).norm();
      if (apart <= distance) distance = apart, nearest = one;
    }
    const bool found = nearest != file.nodes.end();
    if (!found || nearest->second.displacement_system > 1) {
      why = fmt::format("sensor {} at ({:.4g}, {:.4g}, {:.4g}) m {}", sensor.name, at[0], at[1],
                        at[2],
                        found ? "is at a node with axes of its own: write the file in those of "
                                "the scene"
                              : "has no node within a thousandth of the rig: write the nodes' "
                                "coordinates (dataset 15 or 2411) in the scene's axes");
      return {};
    }
    nodes.push_back(nearest->first);
  }
  return nodes;
}

/// Shapes at the sensors of the scene, in their order.
std::vector<MeasuredTableRow> modes_of_table(const std::filesystem::path& path,
                                             const std::string& column,
                                             std::optional<model::ModePlane> plane,
                                             const std::vector<std::string>& sensors) {
  const TextTable table = read_text_table(path);
  const std::string frequency = column.empty() ? "frequency_hz" : column;
  (void)table.column(frequency);  // there is one
  check_shapes(table, sensors);
  std::vector<MeasuredTableRow> rows;
  for (const auto& line : table.rows) {
    MeasuredTableRow mode;
    mode.plane = plane;
    describe::Options keys{
        option(frequency, mode.frequency_hz.value, "").positive(),
        option("damping_ratio", mode.damping_ratio.value, "not in per cent").within(1e-9, 0.999),
        option("damping_std", mode.damping_ratio.std, "").positive(),
        choice("plane", mode.plane, {"any", "in", "out"}, ""),
        option("order", mode.order, "in its plane").within(1, 200),
        option("tension_N", mode.tension_N, "").positive()};
    for (const char* name : {"frequency_std", "frequency_std_hz", "std_hz", "std"}) {
      keys.push_back(option(name, mode.frequency_hz.std, "").positive());
    }
    std::vector<double> shape(sensors.size(), kNaN);
    for (std::size_t s = 0; s < sensors.size(); ++s) {
      keys.push_back(option("shape:" + sensors[s], shape[s], ""));
    }
    fill_row(table, line, keys);
    if (std::isnan(mode.frequency_hz.value)) continue;  // a dash: not measured
    const Eigen::Map<Eigen::VectorXd> at(shape.data(), static_cast<Eigen::Index>(shape.size()));
    if (at.size() > 0 && at.allFinite()) mode.shape = at.cast<std::complex<double>>();
    rows.push_back(std::move(mode));
  }
  if (rows.empty()) {
    throw model::SceneError({table.file, 0, 0, frequency}, "no mode is listed",
                            "one line a mode below the names");
  }
  return rows;
}

}  // namespace

Eigen::Vector3d position_of(const model::Scene& scene, const model::Place& place) {
  const auto node = [&](const std::string& name) -> Eigen::Vector3d {
    const auto at = std::ranges::find(scene.nodes, name, &model::SceneNode::name);
    return at == scene.nodes.end() ? Eigen::Vector3d(0, 0, 0) : at->position;
  };
  const auto member = std::ranges::find(scene.members, place.member, &model::Member::name);
  if (!place.node.empty() || member == scene.members.end()) return node(place.node);
  const Eigen::Vector3d from = node(member->nodes[0]), to = node(member->nodes[1]);
  return from + place.position * (to - from);
}

bool is_universal_file(const std::filesystem::path& path) {
  return signal::format_of(signal::MappedFile(path).bytes()) == "uff";
}

std::vector<MeasuredTableRow> measured_modes(const std::string& path, const std::string& column,
                                             std::optional<model::ModePlane> plane,
                                             const model::Scene& scene, VerbContext& context) {
  context.input(path);
  if (!is_universal_file(path)) {
    std::vector<std::string> sensors;
    for (const auto& sensor : scene.sensors) sensors.push_back(sensor.name);
    return modes_of_table(path, column, plane, sensors);
  }
  if (!column.empty())
    throw UsageError(path + " is a universal file: a column (--column) is that of a table");
  const signal::UffModes file = signal::read_uff_modes(path);
  std::vector<std::string> remarks = file.remarks;
  std::string why;
  const auto nodes = nodes_of_sensors(scene, file, why);
  if (!why.empty()) remarks.push_back("shapes are not used: " + why);
  std::vector<MeasuredTableRow> rows;
  int absent = 0;
  for (const auto& found : file.modes) {
    MeasuredTableRow row;
    row.frequency_hz.value = found.frequency_hz;
    // A ratio that is not positive is none of a mode; it is not fitted.
    if (found.damping_ratio > 0) row.damping_ratio.value = found.damping_ratio;
    row.plane = plane;
    Eigen::VectorXcd shape(static_cast<Eigen::Index>(nodes.size()));
    bool whole = !nodes.empty() && !found.shape.empty();
    for (std::size_t s = 0; s < nodes.size() && whole; ++s) {
      const auto one = found.shape.find(nodes[s]);
      whole = one != found.shape.end();
      if (!whole) break;
      const Eigen::Vector3cd moves(one->second.data());
      shape[static_cast<Eigen::Index>(s)] =
          scene.sensors[s].direction.cast<std::complex<double>>().dot(moves);
    }
    whole = whole && shape.squaredNorm() > 0;
    absent += !whole && !nodes.empty();
    if (whole) row.shape = shape;
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
