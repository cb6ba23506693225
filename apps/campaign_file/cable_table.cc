#include "apps/campaign_file/cable_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "apps/campaign/campaign.h"
#include "apps/results/text_table.h"
#include "model/scene/scene_error.h"

namespace rigfit::apps {
namespace {

class CableRows {
 public:
  explicit CableRows(const std::filesystem::path& path)
      : table_(read_text_table(path, ShortRows::filled)) {
    const auto fail = [&](const std::string& problem, const char* remedy) {
      throw model::SceneError({table_.file, table_.header_line, 0, ""}, problem, remedy);
    };
    for (const char* needed : {"length", "mass_per_length"}) {
      if (table_.find(needed) >= 0) continue;
      fail(fmt::format("no column \"{}\"", needed),
           "a table of cables has name, length, mass_per_length and f1, f2 ...");
    }
    for (std::size_t i = 0; i < table_.columns.size(); ++i) {
      const auto& name = table_.columns[i].name;
      if (name.size() > 1 && name[0] == 'f' &&
          name.find_first_not_of("0123456789", 1) == std::string::npos) {
        frequencies_.push_back(i);
      }
    }
    if (frequencies_.empty() && table_.find("frequencies") < 0) {
      fail("no column of frequencies",
           "name them f1, f2 ..., or put them into one column \"frequencies\"");
    }
    if (table_.rows.empty())
      throw model::SceneError({table_.file, 0, 0, ""}, "no cable", "write one a row");
  }

  [[nodiscard]] std::vector<CableTableRow> read() const {
    std::vector<CableTableRow> rows;
    std::set<std::string> taken;
    for (const auto& row : table_.rows) {
      CableTableRow one;
      one.line = row.line;
      std::string name = name_of_row(row);
      if (name.empty()) name = fmt::format("line {}", row.line);
      try {
        if (!taken.insert(name).second) throw std::invalid_argument("the name is taken");
        one.test = test_of(row);
      } catch (const std::exception& error) {
        one.error = error.what();
      }
      one.test.name = std::move(name);
      rows.push_back(std::move(one));
    }
    return rows;
  }

 private:
  /// Under "name" or "cable". "name" above the first column labels a line of names in logger files
  /// (csv_layout.cc) and is then no title.
  [[nodiscard]] std::string name_of_row(const TextTable::Row& row) const {
    for (const char* title : {"name", "cable"}) {
      if (table_.find(title) >= 0) return table_.text(row, title);
    }
    return table_.columns.front().name.empty() ? row.cells.front() : std::string();
  }

  static void require(const describe::Option& key, double value) {
    if (const auto problem = range_problem(key, value); !problem.empty()) {
      throw std::invalid_argument(key.name + " " + problem);
    }
  }

  /// A cell into the key of the same name in a campaign; a blank one leaves its default.
  void read(const TextTable::Row& row, const describe::Option& key) const {
    const std::string cell = table_.text(row, key.name == "orders" ? "order" : key.name);
    if (cell.empty()) return;
    if (auto* const* word = std::get_if<std::string*>(&key.target)) {
      if (!key.words.empty() &&
          std::find(key.words.begin(), key.words.end(), cell) == key.words.end()) {
        throw std::invalid_argument(
            fmt::format("{} \"{}\" is none of {}", key.name, cell, fmt::join(key.words, ", ")));
      }
      **word = cell;
    } else if (auto* const* list = std::get_if<std::vector<double>*>(&key.target)) {
      std::istringstream words(cell);
      for (std::string number; words >> number;) {
        std::size_t used = 0;
        (*list)->push_back(std::stod(number, &used));
        if (used != number.size()) {
          throw std::invalid_argument(key.name + ": \"" + number + "\" is no number");
        }
        require(key, (*list)->back());
      }
    } else {
      const double value = table_.number(row, key.name);
      if (!std::isfinite(value)) return;
      require(key, value);
      if (auto* const* number = std::get_if<double*>(&key.target)) **number = value;
      if (auto* const* number = std::get_if<std::optional<double>*>(&key.target)) **number = value;
    }
  }

  [[nodiscard]] ident::CableTest test_of(const TextTable::Row& row) const {
    TensionTest test;
    for (const std::size_t column : frequencies_) {
      const double hz = table_.number(row, column);
      if (std::isfinite(hz)) test.frequencies_hz.push_back(hz);
    }
    for (const auto& key : keys_of(test)) read(row, key);
    const auto& cable = test.inputs.test.cable;
    if (!(cable.length_m.value > 0 && cable.mass_per_length.value > 0)) {
      throw std::invalid_argument("length or mass_per_length is blank");
    }
    if (test.frequencies_hz.empty()) throw std::invalid_argument("no frequency");
    test.complete();
    return std::move(test.inputs.test);
  }

  TextTable table_;
  std::vector<std::size_t> frequencies_;
};

}  // namespace

std::vector<CableTableRow> read_cable_table(const std::filesystem::path& path) {
  return CableRows(path).read();
}

}  // namespace rigfit::apps
