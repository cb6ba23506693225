#include "apps/report/figures/tension_plots.h"

#include <fmt/format.h>

#include <cmath>

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

Plot interval_plot(const std::string& id, const ident::TensionResult& result) {
  Plot plot;
  plot.id = id + "-intervals";
  plot.title = "Tension by kind of ends";
  plot.caption = "With 95 % intervals. 0: all kinds together, by their weight";
  plot.x_label = "kind of ends, heaviest first";
  plot.y_label = "tension at mid-span, N";
  auto all = points_of("all together", Origin::modelled, 0);
  all.x = {0};
  all.y = {result.tension_N.value};
  all.low = {result.low};
  all.high = {result.high};
  plot.series.push_back(std::move(all));
  auto each = points_of("one kind of ends", Origin::modelled, 2);
  double number = 0;
  for (const auto& one : result.candidates) {
    if (!one.solved) continue;
    ++number;
    each.x.push_back(number);
    each.y.push_back(one.tension_N.value);
    each.low.push_back(one.low);
    each.high.push_back(one.high);
    plot.caption +=
        fmt::format("; {:g}: {} (weight {:.2g})", number, ident::name_of(one.ends), one.weight);
  }
  plot.series.push_back(std::move(each));
  auto formulas = points_of("closed formulas, lowest mode", Origin::published_model, 0);
  const auto& f = result.formulas;
  for (const auto& [name, value] :
       {std::pair{"string", f.string_N}, std::pair{"pinned beam", f.pinned_beam_N},
        std::pair{"clamped beam", f.clamped_beam_N}, std::pair{"Zui", f.zui_N}}) {
    if (!std::isfinite(value)) continue;
    ++number;
    formulas.x.push_back(number);
    formulas.y.push_back(value);
    plot.caption += fmt::format("; {:g}: {}", number, name);
  }
  plot.caption += ".";
  if (!formulas.x.empty()) plot.series.push_back(std::move(formulas));
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
