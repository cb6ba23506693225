#include "apps/report/page/page_limits.h"

#include <algorithm>
#include <cmath>

namespace rigfit::apps {
namespace {

constexpr std::size_t kPagePoints = 1'200'000;  // of all curves: 3 to 7 bytes each
constexpr std::size_t kFewestPoints = 300;      // of a curve: half a phone's width of extremes
constexpr std::size_t kMostPictures = 250;      // drawn twice, for screen and paper

template <class Use>
void each_plot_on_page(std::span<const ReportPart> parts, Use use) {
  for (const auto& part : parts) {
    for (const auto& block : part.blocks) {
      if (const auto* plot = std::get_if<Plot>(&block)) use(*plot);
      if (const auto* group = std::get_if<PlotGroup>(&block)) {
        for (std::size_t i = 0; i < std::min(group->tabs.size(), kMostTabs); ++i) {
          for (const auto& one : group->tabs[i].plots) use(one);
        }
      }
    }
  }
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

/// Indices of the extremes of every bin, rising.
std::vector<std::size_t> extremes(const std::vector<double>& y, std::size_t bins) {
  std::vector<std::size_t> kept;
  kept.reserve(2 * bins + 2);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const std::size_t from = bin * y.size() / bins, to = (bin + 1) * y.size() / bins;
    std::size_t low = from, high = from;
    for (std::size_t i = from; i < to; ++i) {
      if (!std::isfinite(y[i])) continue;
      if (!std::isfinite(y[low]) || y[i] < y[low]) low = i;
      if (!std::isfinite(y[high]) || y[i] > y[high]) high = i;
    }
    kept.push_back(std::min(low, high));
    if (low != high) kept.push_back(std::max(low, high));
  }
  if (kept.front() != 0) kept.insert(kept.begin(), 0);
  if (kept.back() + 1 != y.size()) kept.push_back(y.size() - 1);
  return kept;
}

std::vector<double> picked(const std::vector<double>& values,
                           const std::vector<std::size_t>& indices) {
  std::vector<double> result;
  if (values.empty()) return result;
  result.reserve(indices.size());
  for (const std::size_t i : indices) result.push_back(values[i]);
  return result;
}

}  // namespace

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
    text += (i > 0 ? "," : "") + quoted(table.columns[i].name);
  }
  text += '\n';
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) text += (i > 0 ? "," : "") + quoted(row[i].text);
    text += '\n';
  }
  return text;
}

Plot on_screen(const Plot& plot, std::size_t most) {
  Plot thin = plot;
  for (auto& series : thin.series) {
    if (series.style == PlotSeries::Style::points || series.x.size() <= most) continue;
    const auto kept = extremes(series.y, std::max<std::size_t>(most / 2, 1));
    for (auto* values : {&series.x, &series.y, &series.low, &series.high}) {
      *values = picked(*values, kept);
    }
  }
  return thin;
}

PageLimits limits_for(std::span<const ReportPart> parts) {
  std::size_t points = 0, curves = 0, plots = 0;
  each_plot_on_page(parts, [&](const Plot& plot) {
    ++plots;
    for (const auto& series : plot.series) {
      points += series.x.size() * (series.low.empty() ? 1 : 3);
      ++curves;
    }
  });
  PageLimits limits;
  limits.pictures = plots <= kMostPictures;
  if (points > kPagePoints) {
    limits.points = std::max(kFewestPoints, kPagePoints / std::max<std::size_t>(curves, 1));
  }
  return limits;
}

}  // namespace rigfit::apps
