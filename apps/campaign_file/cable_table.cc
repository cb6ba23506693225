#include "apps/campaign_file/cable_table.h"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "apps/campaign/campaign.h"
#include "apps/results/text_table.h"
#include "document/document_error.h"
#include "document/toml_table.h"
#include "model/scene/scene_error.h"

namespace rigfit::apps {
namespace {

class CableRows {
 public:
  explicit CableRows(const std::filesystem::path& path) : table_(read_text_table(path)) {
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
      std::string name = table_.text(row, table_.find("name") >= 0 ? "name" : "cable");
      if (name.empty()) name = fmt::format("line {}", row.line);
      try {
        if (!taken.insert(name).second) throw std::invalid_argument("the name is taken");
        one.test = test_of(row);
      } catch (const document::DocumentError& error) {
        one.error = error.where().key + " " + error.problem();
      } catch (const std::exception& error) {
        one.error = error.what();
      }
      one.test.name = std::move(name);
      rows.push_back(std::move(one));
    }
    return rows;
  }

 private:
  /// The row as the keys of a campaign's tension test; what is blank keeps its default.
  [[nodiscard]] ident::TensionInputs test_of(const TextTable::Row& row) const {
    TensionTest test;
    const auto keys = keys_of(test);
    std::string text;
    for (const auto& key : keys) {
      std::string cell = table_.text(row, key.name == "orders" ? "order" : key.name);
      if (std::holds_alternative<std::vector<double>*>(key.target)) {
        if (key.name == "frequencies") {
          for (const std::size_t column : frequencies_) {
            const double hz = table_.number(row, column);
            if (std::isfinite(hz)) cell += fmt::format(" {}", hz);
          }
        }
        std::istringstream words(cell);
        std::string list;
        for (std::string word; words >> word;) list += (list.empty() ? "" : ", ") + word;
        cell = list.empty() ? "" : "[" + list + "]";
      } else if (std::holds_alternative<std::string*>(key.target)) {
        if (!cell.empty()) cell = "'" + cell + "'";
      } else {
        const double value = table_.number(row, key.name);
        cell = std::isfinite(value) ? fmt::format("{}", value) : "";
      }
      if (!cell.empty()) text += key.name + " = " + cell + "\n";
    }
    auto toml = document::TomlTable::parse(text, "");
    read_keys(toml, keys);
    test.complete();
    if (test.inputs.modes.empty()) throw std::invalid_argument("no frequency");
    return std::move(test.inputs);
  }

  TextTable table_;
  std::vector<std::size_t> frequencies_;
};

}  // namespace

std::vector<CableTableRow> read_cable_table(const std::filesystem::path& path) {
  return CableRows(path).read();
}

}  // namespace rigfit::apps
