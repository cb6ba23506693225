// Tables of the report: walks over described lists.
#pragma once

#include "apps/describe/sheet.h"
#include "apps/report/page/report_part.h"

namespace rigfit::apps {

/// Rows of a described list below those that the table has, the first one with `front` before it.
/// The first list gives the columns. Remarks stand out.
void add_rows(ReportTable& table, std::vector<Cell> front, const describe::Table& rows,
              std::optional<Origin> origin);
/// A described list (apps/describe/sheet.h) as a table of the report.
[[nodiscard]] ReportTable described_table(const std::string& id, const std::string& caption,
                                          const describe::Table& table,
                                          std::optional<Origin> origin = std::nullopt);
/// The single values of a described result.
[[nodiscard]] ReportTable described_table(const std::string& id, const std::string& caption,
                                          const std::vector<describe::Sheet::Line>& lines,
                                          std::optional<Origin> origin = std::nullopt);

inline constexpr std::size_t kMostTabs = 60;  ///< states of a group of figures on the page

}  // namespace rigfit::apps
