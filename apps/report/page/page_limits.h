// What a page of thousands of recordings carries itself: curves as a screen shows them, the rows of
// a table that say something, a number of states. Everything is in data/ and figures/ beside it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "apps/report/page/report_part.h"

namespace rigfit::apps {

inline constexpr std::size_t kMostRows = 300;  ///< of a table on the page
inline constexpr std::size_t kMostTabs = 60;   ///< states of a group of figures on the page

/// Indices of the rows on the page: all, or those with a doubtful cell first, in their order.
[[nodiscard]] std::vector<std::size_t> rows_on_page(const ReportTable& table);

/// The whole table for a spreadsheet, as it is shown.
[[nodiscard]] std::string table_csv(const ReportTable& table);

/// Curves of more than `most` points thinned to the extremes of most / 2 bins of equal length, so
/// that every peak stays; points and their bars are kept.
[[nodiscard]] Plot on_screen(const Plot& plot, std::size_t most);

struct PageLimits {
  std::size_t points = 0;  ///< of a curve; 0: all
  bool pictures = true;    ///< figures of the appendix are drawn for paper as well
};
/// Limits under which the figures of these parts take some 8 MB of the page.
[[nodiscard]] PageLimits limits_for(std::span<const ReportPart> parts);

}  // namespace rigfit::apps
