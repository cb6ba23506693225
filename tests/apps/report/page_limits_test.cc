#include "apps/report/page/page_limits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rigfit::apps::page_limits_test {
namespace {

// A peak of one sample among 100000 is there after thinning to 400, as are both ends.
TEST(PageLimits, ThinningKeepsPeaksAndEnds) {
  Plot plot;
  PlotSeries series;
  for (int i = 0; i < 100000; ++i) {
    series.x.push_back(i);
    series.y.push_back(std::sin(1e-3 * i));
  }
  series.y[54321] = 7;
  series.y[12345] = -7;
  plot.series = {series};
  const Plot thin = on_screen(plot, 400);
  const auto& y = thin.series[0].y;
  EXPECT_LE(y.size(), 402u);
  EXPECT_EQ(*std::max_element(y.begin(), y.end()), 7);
  EXPECT_EQ(*std::min_element(y.begin(), y.end()), -7);
  EXPECT_TRUE(std::is_sorted(thin.series[0].x.begin(), thin.series[0].x.end()));
  EXPECT_EQ(thin.series[0].x.front(), 0);
  EXPECT_EQ(thin.series[0].x.back(), 99999);
  // Points are not thinned.
  plot.series[0].style = PlotSeries::Style::points;
  EXPECT_EQ(on_screen(plot, 400).series[0].x.size(), 100000u);
}

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

// Few figures are carried whole; thousands within some millions of values, at least 300 a curve.
TEST(PageLimits, FiguresTakeABoundedPartOfThePage) {
  std::vector<ReportPart> parts(1);
  Plot plot;
  PlotSeries series;
  series.x.assign(10000, 1);
  series.y = series.x;
  plot.series = {series};
  parts[0].blocks.assign(20, plot);
  EXPECT_EQ(limits_for(parts).points, 0u);
  EXPECT_TRUE(limits_for(parts).pictures);
  parts[0].blocks.assign(1000, plot);
  EXPECT_EQ(limits_for(parts).points, 1200u);
  EXPECT_FALSE(limits_for(parts).pictures);
}

}  // namespace
}  // namespace rigfit::apps::page_limits_test
