#include "apps/report/fit/fit_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/modal/modal_files.h"
#include "apps/report/modal/model_overlay.h"

namespace rigfit::apps {

Plot error_by_mode_plot(const FitOutcome& of) {
  Plot plot;
  plot.id = of.fit.name + "-errors-by-mode";
  plot.title = "Model against test, mode by mode";
  plot.caption = "How far the model's frequency lies above the test's.";
  if (!of.held.empty()) plot.caption += " Held out: predicted from the other states.";
  plot.x_label = "frequency of the test, Hz";
  plot.y_label = "model over test, %";
  const auto series_of = [&](const char* name, int variant) {
    PlotSeries series;
    series.name = name;
    series.origin = Origin::modelled;
    series.variant = variant;
    series.style = PlotSeries::Style::points;
    return series;
  };
  const auto add = [&](PlotSeries& series, const ident::UpdatedPair& pair) {
    if (pair.cross_plane) return;
    series.x.push_back(pair.measured_hz);
    series.y.push_back(100 * pair.relative_error);
  };
  PlotSeries before = series_of("before", 2), after = series_of("fitted", 0),
             held = series_of("held out", 1);
  for (const auto& pair : of.result.pairs_before) add(before, pair);
  for (const auto& pair : of.result.pairs) {
    if (pair.cross_plane) continue;
    add(after, pair);
    const auto& mode = of.updates[static_cast<std::size_t>(pair.state)]
                           .measured[static_cast<std::size_t>(pair.measured)];
    const double half = std::isfinite(mode.frequency_hz.std)
                            ? 196 * mode.frequency_hz.std / mode.frequency_hz.value
                            : std::numeric_limits<double>::quiet_NaN();
    after.low.push_back(after.y.back() - half);
    after.high.push_back(after.y.back() + half);
  }
  for (const auto& one : of.held) {
    for (const auto& pair : one.pairs) add(held, pair);
  }
  if (std::any_of(after.low.begin(), after.low.end(), [](double v) { return std::isfinite(v); })) {
    plot.caption += " Bars: the test's own 95 % interval.";
  }
  for (auto* series : {&before, &held, &after}) {
    if (!series->x.empty()) plot.series.push_back(std::move(*series));
  }
  return plot;
}

PlotGroup fit_overlays(const FitOutcome& of, std::vector<ModelCost>& costs) {
  PlotGroup group{of.fit.name + "-overlays", "Test and model, laid over each other", {}};
  for (std::size_t s = 0; s < of.states.size(); ++s) {
    const auto& modal = of.states[s].modal;
    if (!modal.recorded || modal.rig.response.empty() || modal.rig.input.empty() ||
        !modal.recorded->hammer.amplitudes) {
      continue;
    }
    std::vector<ModelVersion> versions{{"before", of.updates[s].scene}};
    for (const auto& held : of.held) {
      if (held.state == static_cast<int>(s) && held.scene) {
        versions.push_back({"held out", *held.scene});
      }
    }
    versions.push_back({"fitted", of.result.scenes[s]});
    const std::string id = fmt::format("{}-{}", of.fit.name, file_word(of.updates[s].name));
    PlotTab tab{of.updates[s].name, {}};
    tab.plots.push_back(frf_overlay_plot(id + "-frf", *modal.recorded, modal.rig, versions));
    for (auto& plot : hit_overlay_plots(id + "-hit", *modal.recorded, modal.rig, versions, costs)) {
      tab.plots.push_back(std::move(plot));
    }
    group.tabs.push_back(std::move(tab));
  }
  return group;
}

}  // namespace rigfit::apps
