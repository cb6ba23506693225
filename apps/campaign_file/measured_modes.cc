#include "apps/campaign_file/measured_modes.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>

#include "apps/campaign_file/table_cells.h"
#include "model/scene/scene_error.h"
#include "signal/numerics/numbers.h"

namespace rigfit::apps {
namespace {

using signal::kNaN;

}  // namespace

std::vector<MeasuredTableRow> read_measured_modes(const std::filesystem::path& path,
                                                  const std::string& column,
                                                  std::optional<model::ModePlane> plane,
                                                  const std::vector<std::string>& sensors,
                                                  const std::vector<std::string>& compare) {
  const auto fail = [&](long line, const std::string& key, const std::string& problem,
                        const std::string& remedy) -> void {
    throw model::SceneError({path.string(), line, 0, key}, problem, remedy);
  };
  std::ifstream file(path, std::ios::binary);
  if (!file || !std::filesystem::is_regular_file(path)) {
    fail(0, "", "cannot be read", "check the path and its permissions");
  }
  const std::string frequency = column.empty() ? "frequency_hz" : column;
  std::vector<std::string> names;
  std::vector<MeasuredTableRow> rows;
  char separator = ',';
  std::string line;
  for (long number = 1; std::getline(file, line); ++number) {
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    const std::string text = trimmed(line);
    if (text.empty() || text[0] == '#') continue;
    if (names.empty()) {
      if (text.find(';') != std::string::npos) separator = ';';
      names = cells_of(line, separator);
      if (std::find(names.begin(), names.end(), frequency) == names.end()) {
        std::string known;
        for (const auto& name : names) known += (known.empty() ? "" : ", ") + name;
        fail(number, frequency, "there is no such column",
             "name the column of the frequencies with --column; there are: " + known);
      }
      for (const auto& name : names) {
        if (!name.starts_with("shape:") ||
            std::find(sensors.begin(), sensors.end(), name.substr(6)) != sensors.end()) {
          continue;
        }
        std::string known;
        for (const auto& sensor : sensors) known += (known.empty() ? "" : ", ") + sensor;
        fail(number, name, "the scene has no such sensor",
             known.empty() ? "add one to the scene" : "there are: " + known);
      }
      continue;
    }
    const auto cells = cells_of(line, separator);
    if (cells.size() > names.size()) {
      fail(number, "", fmt::format("{} cells under {} columns", cells.size(), names.size()),
           "give every cell a column, or remove it");
    }
    const auto cell = [&](const std::string& name) -> std::string {
      for (std::size_t i = 0; i < cells.size(); ++i) {
        if (names[i] == name) return cells[i];
      }
      return "";
    };
    const auto value = [&](const std::string& name, bool positive) {
      const std::string content = cell(name);
      if (content.empty()) return kNaN;
      double parsed = 0;
      const auto [end, error] =
          std::from_chars(content.data(), content.data() + content.size(), parsed);
      if (error != std::errc() || end != content.data() + content.size() ||
          !std::isfinite(parsed) || (positive && parsed <= 0)) {
        fail(number, name, "\"" + content + "\" is no " + (positive ? "positive " : "") + "number",
             "write it with a decimal point, or leave the cell blank");
      }
      return parsed;
    };
    MeasuredTableRow row;
    row.mode.frequency_hz.value = value(frequency, true);
    if (!std::isfinite(row.mode.frequency_hz.value)) continue;  // a dash: not measured
    row.mode.frequency_hz.std = value("std", true);
    row.mode.damping_ratio.value = value("damping_ratio", true);
    if (row.mode.damping_ratio.value >= 1) {
      fail(number, "damping_ratio", "is not below 1", "give it as a fraction, not percent");
    }
    row.mode.damping_ratio.std = value("damping_std", true);
    row.mode.plane = plane;
    const std::string word = cell("plane");
    if (word == "in") {
      row.mode.plane = model::ModePlane::in;
    } else if (word == "out") {
      row.mode.plane = model::ModePlane::out;
    } else if (!word.empty()) {
      fail(number, "plane", "\"" + word + "\" is no plane", "write in, out, or leave it blank");
    }
    for (const auto& name : compare) row.compared.push_back(value(name, true));
    const double tension = value("tension_N", true);
    if (std::isfinite(tension)) row.tension_N = tension;
    Eigen::VectorXcd shape(static_cast<Eigen::Index>(sensors.size()));
    bool whole = !sensors.empty();
    for (std::size_t s = 0; s < sensors.size(); ++s) {
      const double component = value("shape:" + sensors[s], false);
      whole = whole && std::isfinite(component);
      shape[static_cast<Eigen::Index>(s)] = component;
    }
    if (whole) row.mode.shape = shape;
    rows.push_back(std::move(row));
  }
  if (rows.empty()) fail(0, frequency, "no mode is listed", "one line a mode below the names");
  return rows;
}

}  // namespace rigfit::apps
