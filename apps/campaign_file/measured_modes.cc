#include "apps/campaign_file/measured_modes.h"

#include <algorithm>
#include <cmath>

#include "apps/results/text_table.h"
#include "model/scene/scene_error.h"
#include "signal/numerics/numbers.h"

namespace rigfit::apps {
namespace {

using signal::kNaN;

/// A table of modes: cells by the name of their column.
class ModeTable {
 public:
  explicit ModeTable(TextTable table) : table_(std::move(table)) {
    for (const auto& column : table_.columns) names_.push_back(column.name);
  }

  [[nodiscard]] const std::vector<TextTable::Row>& rows() const { return table_.rows; }
  [[nodiscard]] std::ptrdiff_t column(const std::string& name) const {
    return find_column(names_, name);
  }
  [[noreturn]] void fail(long line, const std::string& key, const std::string& problem,
                         const std::string& remedy) const {
    throw model::SceneError({table_.file, line, 0, key}, problem, remedy);
  }
  [[nodiscard]] std::string cell(const TextTable::Row& row, const std::string& name) const {
    const auto at = column(name);
    return at < 0 ? "" : row.cells[static_cast<std::size_t>(at)];
  }
  /// NaN for a blank or without such a column.
  [[nodiscard]] double value(const TextTable::Row& row, const std::string& name,
                             bool positive) const {
    const auto at = column(name);
    if (at < 0) return kNaN;
    const double value = table_.number(row, static_cast<std::size_t>(at));
    if (positive && value <= 0) {
      fail(row.line, name, "\"" + cell(row, name) + "\" is no positive number",
           "correct it, or leave the cell blank");
    }
    return value;
  }

  /// Throws unless there is a column of frequencies, and every column of shapes is of a sensor.
  void check(const std::string& frequency, const std::vector<std::string>& sensors) const {
    const auto listed = [](const std::vector<std::string>& words) {
      std::string all;
      for (const auto& word : words) all += (all.empty() ? "" : ", ") + word;
      return all;
    };
    if (column(frequency) < 0) {
      fail(table_.header_line, frequency, "there is no such column",
           "name the column of the frequencies with --column; there are: " + listed(names_));
    }
    for (const auto& name : names_) {
      if (!name.starts_with("shape:") ||
          std::find(sensors.begin(), sensors.end(), name.substr(6)) != sensors.end()) {
        continue;
      }
      fail(table_.header_line, name, "the scene has no such sensor",
           sensors.empty() ? "add one to the scene" : "there are: " + listed(sensors));
    }
  }

 private:
  TextTable table_;
  std::vector<std::string> names_;
};

}  // namespace

std::vector<MeasuredTableRow> read_measured_modes(const std::filesystem::path& path,
                                                  const std::string& column,
                                                  std::optional<model::ModePlane> plane,
                                                  const std::vector<std::string>& sensors,
                                                  const std::vector<std::string>& compare) {
  const ModeTable table(read_text_table(path, ShortRows::filled));
  const std::string frequency = column.empty() ? "frequency_hz" : column;
  table.check(frequency, sensors);
  std::vector<MeasuredTableRow> rows;
  for (const auto& line : table.rows()) {
    const auto value = [&](const std::string& name, bool positive) {
      return table.value(line, name, positive);
    };
    MeasuredTableRow row;
    row.mode.frequency_hz.value = value(frequency, true);
    if (!std::isfinite(row.mode.frequency_hz.value)) continue;  // a dash: not measured
    row.mode.frequency_hz.std = kNaN;
    for (const char* name : {"frequency_std", "frequency_std_hz", "std_hz", "std"}) {
      if (const double std = value(name, true); !std::isnan(std)) row.mode.frequency_hz.std = std;
    }
    row.mode.damping_ratio.value = value("damping_ratio", true);
    if (row.mode.damping_ratio.value >= 1) {
      table.fail(line.line, "damping_ratio", "is not below 1",
                 "give it as a fraction, not percent");
    }
    row.mode.damping_ratio.std = value("damping_std", true);
    row.mode.plane = plane;
    const std::string word = table.cell(line, "plane");
    if (word == "in") {
      row.mode.plane = model::ModePlane::in;
    } else if (word == "out") {
      row.mode.plane = model::ModePlane::out;
    } else if (!word.empty()) {
      table.fail(line.line, "plane", "\"" + word + "\" is no plane",
                 "write in, out, or leave it blank");
    }
    const double order = value("order", true);
    if (std::isfinite(order)) {
      if (order != std::round(order) || order > 200) {
        table.fail(line.line, "order", "is no whole number of 1 to 200",
                   "1 is the first mode of its plane");
      }
      row.mode.order = static_cast<int>(order);
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
  if (rows.empty())
    table.fail(0, frequency, "no mode is listed", "one line a mode below the names");
  return rows;
}

}  // namespace rigfit::apps
