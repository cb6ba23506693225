#include "apps/report/page/page_limits.h"

#include <algorithm>

#include "apps/report/drawing/html_text.h"

namespace rigfit::apps {

std::vector<std::size_t> rows_on_page(const ReportTable& table) {
  std::vector<std::size_t> rows(table.rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = i;
  if (rows.size() <= kMostRows) return rows;
  const auto says_something = [&](std::size_t row) {
    return std::any_of(table.rows[row].begin(), table.rows[row].end(),
                       [](const Cell& cell) { return cell.doubtful; });
  };
  std::stable_partition(rows.begin(), rows.end(), says_something);
  rows.resize(kMostRows);
  std::sort(rows.begin(), rows.end());
  return rows;
}

std::string table_csv(const ReportTable& table) {
  std::string text;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    text += (i > 0 ? "," : "") + csv_quoted(table.columns[i].name);
  }
  text += '\n';
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i)
      text += (i > 0 ? "," : "") + csv_quoted(row[i].text);
    text += '\n';
  }
  return text;
}

}  // namespace rigfit::apps
