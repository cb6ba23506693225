#include "apps/results/result_table.h"

#include <limits>

#include "apps/results/text_table.h"
#include "model/scene/toml_table.h"

namespace rigfit::apps {

std::size_t ResultTable::column(const std::string& name) const {
  const auto index = find_column(columns, name);
  if (index >= 0) {
    const auto at = static_cast<std::size_t>(index);
    if (at < faults.size() && faults[at]) throw *faults[at];
    return at;
  }
  std::string known;
  for (const auto& column : columns) known += (known.empty() ? "\"" : ", \"") + column + "\"";
  const auto nearest = model::nearest_word(name, columns);
  throw model::SceneError({file, header_line, 0, ""}, "has no column \"" + name + "\"",
                          nearest ? "did you mean \"" + *nearest + "\"?" : "its columns: " + known);
}

ResultTable read_result_table(const std::filesystem::path& path) {
  const TextTable text = read_text_table(path);
  ResultTable table;
  table.file = text.file;
  table.header_line = text.header_line;
  for (const auto& column : text.columns) table.columns.push_back(column.name);
  table.faults.resize(text.columns.size());
  for (const auto& row : text.rows) {
    std::vector<double> numbers(text.columns.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t c = 0; c < numbers.size(); ++c) {
      try {
        numbers[c] = text.number(row, c);
      } catch (const model::SceneError& error) {
        if (!table.faults[c]) table.faults[c] = error;
      }
    }
    table.rows.push_back(std::move(numbers));
    table.lines.push_back(row.line);
  }
  return table;
}

}  // namespace rigfit::apps
