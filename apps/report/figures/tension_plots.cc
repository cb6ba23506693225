#include "apps/report/figures/tension_plots.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

namespace rigfit::apps {
namespace {

PlotSeries points_of(std::string name, Origin origin, int variant) {
  PlotSeries series;
  series.name = std::move(name);
  series.origin = origin;
  series.variant = variant;
  series.style = PlotSeries::Style::points;
  return series;
}

/// Modes over their number; `value` gives the ordinate of a mode.
template <class Value>
void add_modes(Plot& plot, PlotSeries series, const ident::TensionCandidate& candidate,
               Value value) {
  for (const auto& mode : candidate.modes) {
    if (mode.order == 0) continue;
    series.x.push_back(mode.order);
    series.y.push_back(value(mode));
  }
  if (!series.x.empty()) plot.series.push_back(std::move(series));
}

/// A value with its interval (NaN: none) as a series of its own, named in the legend.
void add_value(Plot& plot, PlotSeries series, double value, double low, double high) {
  series.x = {static_cast<double>(plot.series.size() + 1)};
  series.y = {value};
  if (std::isfinite(low) && std::isfinite(high)) {
    series.low = {low};
    series.high = {high};
  }
  plot.series.push_back(std::move(series));
}

Plot interval_plot(const std::string& id, const ident::TensionResult& result) {
  Plot plot;
  plot.id = id + "-intervals";
  plot.title = "Tension by kind of ends";
  plot.caption =
      "All kinds together by their weight, each kind of ends by itself with its 95 % interval, and "
      "closed formulas from the lowest mode, in the order of the legend.";
  plot.x_label = "in the order of the legend";
  plot.y_label = "tension at mid-span, N";
  add_value(plot, points_of("all together", Origin::modelled, 0), result.tension_N.value,
            result.low, result.high);
  int variant = 1;
  for (const auto& one : result.candidates) {
    if (!one.solved) continue;
    add_value(
        plot,
        points_of(fmt::format("{} ends (weight {:.2g})", ident::name_of(one.ends), one.weight),
                  Origin::modelled, variant++),
        one.tension_N.value, one.low, one.high);
  }
  const auto& f = result.formulas;
  const double none = std::numeric_limits<double>::quiet_NaN();
  variant = 0;
  for (const auto& [name, value] :
       {std::pair{"string", f.string_N}, std::pair{"pinned beam", f.pinned_beam_N},
        std::pair{"clamped beam", f.clamped_beam_N}, std::pair{"Zui", f.zui_N}}) {
    if (!std::isfinite(value)) continue;
    add_value(plot, points_of(fmt::format("formula: {}", name), Origin::published_model, variant++),
              value, none, none);
  }
  return plot;
}

}  // namespace

std::vector<Plot> tension_plots(const std::string& id, const ident::TensionResult& result) {
  if (result.candidates.empty()) return {};
  Plot frequencies, errors;
  frequencies.id = id + "-frequencies";
  frequencies.title = "Frequencies over mode number";
  frequencies.caption = "Measured, and the model's with each kind of ends.";
  frequencies.x_label = errors.x_label = "mode number";
  frequencies.y_label = "frequency, Hz";
  errors.id = id + "-errors";
  errors.title = "Model over test, mode by mode";
  errors.caption =
      "A trend over the mode number means that bending stiffness, ends or sag are not those of the "
      "cable.";
  errors.y_label = "model over test, %";
  frequencies.link = errors.link = id;
  add_modes(frequencies, points_of("measured", Origin::measured, 0), result.candidates.front(),
            [](const auto& mode) { return mode.measured_hz; });
  int variant = 0;
  for (const auto& one : result.candidates) {
    if (!one.solved) continue;
    const auto name = fmt::format("{} ends, weight {:.2g}", ident::name_of(one.ends), one.weight);
    add_modes(frequencies, points_of(name, Origin::modelled, variant), one,
              [](const auto& mode) { return mode.model_hz; });
    add_modes(errors, points_of(name, Origin::modelled, variant), one,
              [](const auto& mode) { return 100 * mode.relative_error; });
    ++variant;
  }
  return {std::move(frequencies), std::move(errors), interval_plot(id, result)};
}

}  // namespace rigfit::apps
