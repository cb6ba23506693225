#include "apps/report/page/report_part.h"

#include "apps/report/drawing/html_text.h"

namespace rigfit::apps {

void add_rows(ReportTable& table, std::vector<Cell> front, const describe::Table& rows,
              std::optional<Origin> origin) {
  const bool first = table.columns.size() == front.size();
  for (std::size_t c = 0; c < rows.heads.size() && first; ++c) {
    table.columns.push_back({with_signs(rows.heads[c]), std::nullopt, rows.numeric[c]});
  }
  for (const auto& row : rows.rows) {
    auto& cells = table.rows.emplace_back(front);
    for (std::size_t c = 0; c < row.size(); ++c) {
      Cell& cell = cells.emplace_back(with_signs(row[c]));
      if (rows.numeric[c]) cell.origin = origin;
      cell.doubtful = (rows.heads[c] == "remark" && !row[c].empty() && row[c] != "-") ||
                      row[c].starts_with("rejected: ");
    }
    front.assign(front.size(), Cell());
  }
}

ReportTable described_table(const std::string& id, const std::string& caption,
                            const describe::Table& table, std::optional<Origin> origin) {
  ReportTable shown{id, caption};
  add_rows(shown, {}, table, origin);
  return shown;
}

ReportTable described_table(const std::string& id, const std::string& caption,
                            const std::vector<describe::Sheet::Line>& lines,
                            std::optional<Origin> origin) {
  ReportTable shown{id, caption, {{"quantity", {}, false}, {"value", origin}}};
  for (const auto& line : lines) shown.rows.push_back({line.label, with_signs(line.text)});
  return shown;
}

}  // namespace rigfit::apps
