// Tables of the report: walks over described lists, matrices whose cells are the darker the larger
// they are, and what a page of thousands of recordings carries of a long table. The rest is in
// data/ beside the page.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "apps/describe/sheet.h"
#include "apps/report/page/report_part.h"

namespace rigfit::apps {

/// Text of a terminal with the signs of print: "±", "−", "m²".
[[nodiscard]] std::string with_signs(std::string text);

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

/// `values`: rows x columns, 0..1.
[[nodiscard]] ReportTable matrix_table(const std::string& id, const std::string& caption,
                                       const Eigen::MatrixXd& values,
                                       const std::vector<std::string>& names);

inline constexpr std::size_t kMostRows = 300;  ///< rows of a table on the page
inline constexpr std::size_t kMostTabs = 60;   ///< states of a group of figures on the page

/// Indices of the rows on the page: all, or those with a doubtful cell first, in their order.
[[nodiscard]] std::vector<std::size_t> rows_on_page(const ReportTable& table);

/// The whole table for a spreadsheet, as it is shown.
[[nodiscard]] std::string table_csv(const ReportTable& table);

}  // namespace rigfit::apps
