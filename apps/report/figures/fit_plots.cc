#include "apps/report/figures/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/drawing/html_text.h"
#include "apps/report/page/parameter_words.h"
#include "apps/report/page/shaded_tables.h"

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

std::optional<ReportTable> budget_table(const std::string& id, const ident::UpdateResult& result) {
  std::vector<Shares> budgets;
  for (const auto& parameter : result.parameters) {
    if (parameter.budget.empty()) continue;
    Shares shares{parameter_words(parameter.name), {}};
    for (const auto& term : parameter.budget) {
      shares.parts.emplace_back(term.source, term.std * term.std);
    }
    budgets.push_back(std::move(shares));
  }
  if (budgets.empty()) return std::nullopt;
  return share_table(id,
                     "Where the uncertainty of each parameter comes from: shares of its variance. "
                     "The largest is what to improve first.",
                     budgets);
}

}  // namespace rigfit::apps
