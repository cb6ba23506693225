#include "apps/campaign_file/result_table.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>

#include "apps/campaign_file/table_cells.h"
#include "model/scene/scene_error.h"
#include "model/scene/toml_table.h"

namespace rigfit::apps {
std::size_t ResultTable::column(const std::string& name) const {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i] == name) return i;
  }
  std::string known;
  for (const auto& column : columns) known += (known.empty() ? "\"" : ", \"") + column + "\"";
  const auto nearest = model::nearest_word(name, columns);
  throw model::SceneError({file, 1, 0, ""}, "has no column \"" + name + "\"",
                          nearest ? "did you mean \"" + *nearest + "\"?" : "its columns: " + known);
}

ResultTable read_result_table(const std::filesystem::path& path) {
  ResultTable table;
  table.file = path.string();
  const auto fail = [&](long line, long column, const std::string& problem, const char* remedy) {
    throw model::SceneError({table.file, line, column, ""}, problem, remedy);
  };
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    fail(0, 0, "there is no such file", "check the path; it starts at the campaign's folder");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) fail(0, 0, "cannot be read", "check its permissions");
  std::string line;
  char separator = ',';
  for (long number = 1; std::getline(file, line); ++number) {
    if (number == 1 && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);
    if (trimmed(line).empty() || line[0] == '#') continue;
    if (line.size() > 100000) fail(number, 0, "this line is too long", "give a CSV table");
    if (table.columns.empty()) {
      if (line.find(';') != std::string::npos) separator = ';';
      table.columns = cells_of(line, separator);
      continue;
    }
    const auto cells = cells_of(line, separator);
    if (cells.size() != table.columns.size()) {
      fail(number, 0,
           fmt::format("has {} values, the header {}", cells.size(), table.columns.size()),
           "give every row a value or a blank for each column");
    }
    std::vector<double> row;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      double value = std::numeric_limits<double>::quiet_NaN();
      if (!cells[i].empty()) {
        const char* end = cells[i].data() + cells[i].size();
        const auto parsed = std::from_chars(cells[i].data(), end, value);
        if (parsed.ec != std::errc() || parsed.ptr != end || !std::isfinite(value)) {
          fail(number, static_cast<long>(i + 1),
               fmt::format("\"{}\" in column \"{}\" is not a number", cells[i], table.columns[i]),
               "write numbers with a decimal point, and nothing where there is no value");
        }
      }
      row.push_back(value);
    }
    table.rows.push_back(std::move(row));
    table.lines.push_back(number);
  }
  if (table.rows.empty()) fail(0, 0, "holds no rows", "give a header line and rows of numbers");
  return table;
}

}  // namespace rigfit::apps
