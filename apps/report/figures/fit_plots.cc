#include "apps/report/figures/fit_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/drawing/html_text.h"
#include "apps/report/page/share_bars.h"

namespace rigfit::apps {
namespace {

constexpr double kNormal95 = 1.959963984540054;  // two-sided 95 % of a normal distribution

PlotSeries points_of(const char* name, int variant) {
  PlotSeries series;
  series.name = name;
  series.origin = Origin::modelled;
  series.variant = variant;
  series.style = PlotSeries::Style::points;
  return series;
}

/// The measured mode of a pair, with its standard uncertainty; NaN where it has none.
double measured_std(const FitFigures& fit, const ident::UpdatedPair& pair) {
  const auto& measured = fit.states[static_cast<std::size_t>(pair.state)].measured;
  return measured[static_cast<std::size_t>(pair.measured)].frequency_hz.std;
}

/// Calls use(pair, series) for pairs before the fit, held out and fitted; gives the series drawn.
template <class Use>
std::vector<PlotSeries> each_pair(const FitFigures& fit, Use use) {
  PlotSeries before = points_of("before the fit", 2), after = points_of("fitted", 0),
             held = points_of("held out, predicted", 1);
  for (const auto& pair : fit.result.pairs_before) use(pair, before, false);
  for (const auto& one : fit.held) {
    for (const auto& pair : one.pairs) use(pair, held, false);
  }
  for (const auto& pair : fit.result.pairs) use(pair, after, true);
  std::vector<PlotSeries> list;
  for (auto* series : {&before, &held, &after}) {
    if (!series->x.empty()) list.push_back(std::move(*series));
  }
  return list;
}

}  // namespace

Plot parity_plot(const std::string& id, const FitFigures& fit) {
  Plot plot;
  plot.id = id;
  plot.title = "Model against test, all modes";
  plot.caption =
      "On the line the model has the test's frequency. Bars: 95 % of the test's and the fitted "
      "model's uncertainty together.";
  plot.x_label = "frequency of the test, Hz";
  plot.y_label = "frequency of the model, Hz";
  plot.same_axes = true;
  double low = std::numeric_limits<double>::infinity(), high = 0;
  auto list = each_pair(fit, [&](const ident::UpdatedPair& pair, PlotSeries& series, bool fitted) {
    if (pair.cross_plane) return;
    series.x.push_back(pair.measured_hz);
    series.y.push_back(pair.model_hz);
    low = std::min({low, pair.measured_hz, pair.model_hz});
    high = std::max({high, pair.measured_hz, pair.model_hz});
    if (!fitted) return;
    double variance = 0;
    for (const double std : {pair.model_std_hz, measured_std(fit, pair)}) {
      if (std::isfinite(std)) variance += std * std;
    }
    const double half =
        variance > 0 ? kNormal95 * std::sqrt(variance) : std::numeric_limits<double>::quiet_NaN();
    series.low.push_back(pair.model_hz - half);
    series.high.push_back(pair.model_hz + half);
  });
  if (list.empty()) return plot;
  plot.log_x = plot.log_y = high > 10 * low;
  PlotSeries equal;
  equal.name = "model equals test";
  equal.origin = Origin::measured;
  equal.style = PlotSeries::Style::dashed;
  equal.x = equal.y = {low, high};
  plot.series.push_back(std::move(equal));
  for (auto& series : list) plot.series.push_back(std::move(series));
  return plot;
}

Plot error_by_mode_plot(const std::string& id, const FitFigures& fit) {
  Plot plot;
  plot.id = id;
  plot.title = "Model against test, mode by mode";
  plot.caption = "How far the model's frequency lies above the test's.";
  if (!fit.held.empty()) plot.caption += " Held out: predicted from the other states.";
  plot.x_label = "frequency of the test, Hz";
  plot.y_label = "model over test, %";
  bool bars = false;
  plot.series =
      each_pair(fit, [&](const ident::UpdatedPair& pair, PlotSeries& series, bool fitted) {
        if (pair.cross_plane) return;
        series.x.push_back(pair.measured_hz);
        series.y.push_back(100 * pair.relative_error);
        if (!fitted) return;
        const double half = 100 * kNormal95 * measured_std(fit, pair) / pair.measured_hz;
        bars = bars || std::isfinite(half);
        series.low.push_back(series.y.back() - half);
        series.high.push_back(series.y.back() + half);
      });
  if (bars) plot.caption += " Bars: the test's own 95 % interval.";
  return plot;
}

std::optional<Picture> budget_picture(const std::string& id, const ident::UpdateResult& result) {
  std::vector<ShareBar> bars;
  for (const auto& parameter : result.parameters) {
    if (parameter.budget.empty()) continue;
    ShareBar bar;
    bar.name = parameter.name;
    bar.value = shown_estimate(parameter.value, parameter.std);
    for (const auto& term : parameter.budget)
      bar.parts.emplace_back(term.source, term.std * term.std);
    bars.push_back(std::move(bar));
  }
  if (bars.empty()) return std::nullopt;
  return share_bars(id, "Where the uncertainty of each parameter comes from",
                    "Shares of the variance. The longest part is what to improve first.", bars);
}

std::optional<Plot> pair_mac_plot(const std::string& id, const FitFigures& fit) {
  Plot plot;
  plot.id = id;
  plot.title = "MAC of each pair";
  plot.caption = "1: the measured shape and the model's are the same at the sensors.";
  plot.x_label = "frequency of the test, Hz";
  plot.y_label = "MAC";
  plot.series =
      each_pair(fit, [&](const ident::UpdatedPair& pair, PlotSeries& series, bool /*fitted*/) {
        if (pair.cross_plane || !(pair.mac > 0)) return;
        series.x.push_back(pair.measured_hz);
        series.y.push_back(pair.mac);
      });
  if (plot.series.empty()) return std::nullopt;
  return plot;
}

}  // namespace rigfit::apps
