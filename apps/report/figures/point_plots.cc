#include "apps/report/figures/point_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/report/drawing/html_text.h"

namespace rigfit::apps {
namespace {

constexpr double kPointBar95 = 1.959963984540054;  // two-sided 95 % of a normal distribution

bool at_points(const signal::IdentifiedMode& mode) { return mode.points.size() > 1; }

std::string point_name(const signal::ModeAtPoint& at) {
  return at.point.name.empty() ? fmt::format("{}", at.order + 1) : at.point.name;
}

}  // namespace

std::optional<Plot> points_plot(const std::string& id,
                                const std::vector<signal::IdentifiedMode>& modes, Origin origin) {
  Plot plot;
  plot.id = id;
  plot.title = "Frequency of each mode, point by point";
  plot.caption =
      "How far the frequency at each measured point lies from the mode's mean. Bars: 95 % of the "
      "point's own error; points further apart than their bars: the structure changed between "
      "them. A line: a trend from point to point that chance does not explain.";
  plot.x_label = "point, in the order measured";
  plot.y_label = "deviation from the mean, ppm";
  int variant = 0;
  for (const auto& mode : modes) {
    if (!at_points(mode)) continue;
    const double mean = mode.frequency_hz.value;
    PlotSeries points, trend;
    points.name = fmt::format("{} Hz", shown(mean, 5));
    points.origin = origin;
    points.style = PlotSeries::Style::points;
    points.variant = variant;
    double middle = 0;
    for (const auto& at : mode.points) {
      const double half = 1e6 * kPointBar95 * at.frequency_hz.std / mean;
      points.x.push_back(static_cast<double>(at.order + 1));
      points.y.push_back(1e6 * (at.frequency_hz.value / mean - 1));
      points.low.push_back(points.y.back() - half);
      points.high.push_back(points.y.back() + half);
      middle += points.x.back() / static_cast<double>(mode.points.size());
    }
    if (mode.has_trend) {
      trend.name = points.name + ", trend";
      trend.group = "trend";
      trend.origin = Origin::modelled;
      trend.variant = variant;
      const auto [first, last] = std::minmax_element(points.x.begin(), points.x.end());
      for (const double x : {*first, *last}) {
        trend.x.push_back(x);
        trend.y.push_back(1e6 * mode.trend_hz.value * (x - middle) / mean);
      }
    }
    plot.series.push_back(std::move(points));
    if (!trend.x.empty()) plot.series.push_back(std::move(trend));
    ++variant;
  }
  if (plot.series.empty()) return std::nullopt;
  return plot;
}

std::optional<ReportTable> points_table(const std::string& id,
                                        const std::vector<signal::IdentifiedMode>& modes,
                                        Origin origin) {
  ReportTable table;
  table.id = id;
  table.caption =
      "Each mode's frequency over the points measured: mean with its standard uncertainty, scatter "
      "between points beyond their own errors, change from one point to the next.";
  table.columns = {{"mean, Hz", origin},
                   {"points", {}, true},
                   {"scatter between points, Hz", origin},
                   {"trend, Hz a point", origin},
                   {"trend beyond chance", {}, false},
                   {"lowest, Hz", origin},
                   {"highest, Hz", origin}};
  for (const auto& mode : modes) {
    if (!at_points(mode)) continue;
    const auto [low, high] = std::minmax_element(
        mode.points.begin(), mode.points.end(),
        [](const auto& a, const auto& b) { return a.frequency_hz.value < b.frequency_hz.value; });
    const auto end = [&](const signal::ModeAtPoint& at) {
      return fmt::format("{} ({})", shown_bound(at.frequency_hz.value, at.frequency_hz.std),
                         point_name(at));
    };
    Cell certain(!std::isfinite(mode.trend_hz.value) ? "too few points"
                 : mode.has_trend                    ? "yes"
                                                     : "no");
    certain.doubtful = mode.has_trend;
    table.rows.push_back(
        {shown_estimate(mode.frequency_hz.value, mode.frequency_hz.std),
         fmt::format("{}", mode.points.size()), shown(mode.between_points_std_hz, 2),
         std::isfinite(mode.trend_hz.value) ? shown_estimate(mode.trend_hz.value, mode.trend_hz.std)
                                            : std::string(),
         certain, end(*low), end(*high)});
  }
  if (table.rows.empty()) return std::nullopt;
  return table;
}

}  // namespace rigfit::apps
