// What a page of thousands of recordings carries itself: the rows of a table that say something, a
// number of states. Everything is in data/ and figures/ beside it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "apps/report/page/report_part.h"

namespace rigfit::apps {

inline constexpr std::size_t kMostRows = 300;  ///< rows of a table on the page
inline constexpr std::size_t kMostTabs = 60;   ///< states of a group of figures on the page

/// Indices of the rows on the page: all, or those with a doubtful cell first, in their order.
[[nodiscard]] std::vector<std::size_t> rows_on_page(const ReportTable& table);

/// The whole table for a spreadsheet, as it is shown.
[[nodiscard]] std::string table_csv(const ReportTable& table);

}  // namespace rigfit::apps
