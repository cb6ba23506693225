#include "apps/campaign_file/cable_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "apps/results/text_table.h"
#include "model/scene/scene_error.h"

namespace rigfit::apps {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class CableRows {
 public:
  explicit CableRows(const std::filesystem::path& path)
      : table_(read_text_table(path, ShortRows::filled)) {
    for (const auto& column : table_.columns) names_.push_back(column.name);
    for (const char* needed : {"length", "mass_per_length"}) {
      if (find_column(names_, needed) < 0) {
        throw model::SceneError(
            {table_.file, table_.header_line, 0, ""}, fmt::format("no column \"{}\"", needed),
            "a table of cables has name, length, mass_per_length and f1, f2 ...");
      }
    }
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const auto& name = names_[i];
      if (name.size() > 1 && name[0] == 'f' &&
          name.find_first_not_of("0123456789", 1) == std::string::npos) {
        frequencies_.push_back(i);
      }
    }
    if (frequencies_.empty() && find_column(names_, "frequencies") < 0) {
      throw model::SceneError({table_.file, table_.header_line, 0, ""}, "no column of frequencies",
                              "name them f1, f2 ..., or put them into one column \"frequencies\"");
    }
    if (table_.rows.empty()) {
      throw model::SceneError({table_.file, 0, 0, ""}, "no cable", "write one a row");
    }
  }

  [[nodiscard]] std::vector<CableTableRow> read() const {
    std::vector<CableTableRow> rows;
    std::set<std::string> taken;
    for (const auto& row : table_.rows) {
      CableTableRow one;
      one.line = row.line;
      one.test.name = name_of_row(row);
      if (one.test.name.empty()) one.test.name = fmt::format("line {}", row.line);
      try {
        if (!taken.insert(one.test.name).second) throw std::invalid_argument("the name is taken");
        fill(row, one.test);
      } catch (const std::exception& error) {
        one.error = error.what();
      }
      rows.push_back(std::move(one));
    }
    return rows;
  }

 private:
  /// Under "name" or "cable". "name" above the first column labels a line of names in logger files
  /// (csv_layout.cc) and is then no title.
  [[nodiscard]] std::string name_of_row(const TextTable::Row& row) const {
    for (const char* title : {"name", "cable"}) {
      if (find_column(names_, title) >= 0) return text(row, title);
    }
    return names_.front().empty() ? row.cells.front() : std::string();
  }

  [[nodiscard]] std::string text(const TextTable::Row& row, const std::string& name) const {
    const auto column = find_column(names_, name);
    if (column < 0) return {};
    auto cell = row.cells[static_cast<std::size_t>(column)];
    const auto begin = cell.find_first_not_of(" \t"), end = cell.find_last_not_of(" \t");
    return begin == std::string::npos ? std::string() : cell.substr(begin, end - begin + 1);
  }

  [[nodiscard]] double number(const TextTable::Row& row, const std::string& name) const {
    const auto column = find_column(names_, name);
    return column < 0 ? kNaN : table_.number(row, static_cast<std::size_t>(column));
  }

  /// A value with its `_std`, 0 where there is none; nothing where blank.
  [[nodiscard]] std::optional<signal::Estimate> estimate(const TextTable::Row& row,
                                                         const std::string& name) const {
    const double value = number(row, name), std = number(row, name + "_std");
    if (!std::isfinite(value)) return std::nullopt;
    if (std < 0) throw std::invalid_argument(name + "_std is negative");
    return signal::Estimate{value, std::isfinite(std) ? std : 0};
  }

  [[nodiscard]] static std::size_t choice(const std::string& name, const std::string& value,
                                          const std::vector<std::string>& known) {
    const auto found = std::find(known.begin(), known.end(), value);
    if (found == known.end()) {
      throw std::invalid_argument(
          fmt::format("{} \"{}\" is none of {}", name, value, fmt::join(known, ", ")));
    }
    return static_cast<std::size_t>(found - known.begin());
  }

  void fill(const TextTable::Row& row, ident::CableTest& test) const {
    const auto length = estimate(row, "length"), mass = estimate(row, "mass_per_length");
    if (!length || !mass) throw std::invalid_argument("length or mass_per_length is blank");
    auto& cable = test.cable;
    cable.length_m = *length;
    cable.mass_per_length = *mass;
    cable.EI_Nm2 = estimate(row, "EI");
    cable.EA_N = estimate(row, "EA");
    const double inclination = number(row, "inclination");
    if (std::isfinite(inclination)) cable.inclination_deg = inclination;
    if (const auto of = text(row, "mass_of"); !of.empty()) {
      cable.mass_reference = choice("mass_of", of, {"installed", "unstretched"}) == 0
                                 ? ident::MassReference::installed
                                 : ident::MassReference::unstretched;
    }
    if (const auto ends = text(row, "ends"); !ends.empty()) {
      (void)choice("ends", ends, {ident::kCableEndsWords.begin(), ident::kCableEndsWords.end()});
      test.options.ends = ident::cable_ends(ends);
    }
    std::optional<model::ModePlane> plane;
    if (const auto name = text(row, "plane"); !name.empty()) {
      const auto kind = choice("plane", name, {"in", "out", "any"});
      if (kind < 2) plane = kind == 0 ? model::ModePlane::in : model::ModePlane::out;
    }
    const double std = number(row, "frequency_std");
    if (std < 0) throw std::invalid_argument("frequency_std is negative");
    const auto add = [&](double hz) {
      if (!std::isfinite(hz)) return;
      ident::MeasuredMode mode;
      mode.frequency_hz = {hz, std > 0 ? std : kNaN};
      mode.damping_ratio = {kNaN, kNaN};
      mode.plane = plane;
      test.modes.push_back(std::move(mode));
    };
    for (const std::size_t column : frequencies_) add(table_.number(row, column));
    std::istringstream words(text(row, "frequencies"));
    for (std::string word; words >> word;) {
      std::size_t used = 0;
      const double value = std::stod(word, &used);
      if (used != word.size()) throw std::invalid_argument("\"" + word + "\" is no frequency");
      add(value);
    }
    if (test.modes.empty()) throw std::invalid_argument("no frequency");
    std::istringstream orders(text(row, "order"));
    for (std::size_t i = 0; orders >> std::ws && !orders.eof(); ++i) {
      int order = 0;
      if (!(orders >> order) || order < 1 || i >= test.modes.size()) {
        throw std::invalid_argument("order \"" + text(row, "order") +
                                    "\" is no list of one whole number a frequency");
      }
      test.modes[i].order = order;
    }
  }

  TextTable table_;
  std::vector<std::string> names_;
  std::vector<std::size_t> frequencies_;
};

}  // namespace

std::vector<CableTableRow> read_cable_table(const std::filesystem::path& path) {
  return CableRows(path).read();
}

}  // namespace rigfit::apps
