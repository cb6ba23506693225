#include "apps/report/page/page_limits.h"

#include <gtest/gtest.h>

#include <string>

namespace rigfit::apps::page_limits_test {
namespace {

TEST(PageLimits, RowsWithRemarksComeFirst) {
  ReportTable table;
  table.columns = {{"file", {}, false}};
  for (int i = 0; i < 5000; ++i) {
    Cell cell(std::to_string(i));
    cell.doubtful = i == 4321;
    table.rows.push_back({cell});
  }
  const auto rows = rows_on_page(table);
  EXPECT_EQ(rows.size(), kMostRows);
  EXPECT_EQ(rows.back(), 4321u);
  EXPECT_EQ(table_csv(table).substr(0, 11), "\"file\"\n\"0\"\n");
}

}  // namespace
}  // namespace rigfit::apps::page_limits_test
