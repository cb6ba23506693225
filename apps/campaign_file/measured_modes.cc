#include "apps/campaign_file/measured_modes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apps/results/text_table.h"
#include "model/scene/scene_error.h"
#include "signal/numerics/numbers.h"

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
                                                  const std::vector<std::string>& sensors,
                                                  const std::vector<std::string>& compare) {
  const TextTable table = read_text_table(path, ShortRows::filled);
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
    for (const auto& name : compare) row.compared.push_back(positive(name));
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

}  // namespace rigfit::apps
