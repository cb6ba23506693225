#include "apps/report/modal/modal_part.h"

#include <fmt/format.h>

#include <cmath>

#include "ident/campaign/modal/mode_lines.h"

namespace rigfit::apps {
namespace {

constexpr int kSteps = 48;  // from the lowest to the highest tension: lines look smooth

PlotSeries points_of(const std::string& name, Origin origin, int variant) {
  PlotSeries series;
  series.name = name;
  series.origin = origin;
  series.variant = variant;
  series.style = PlotSeries::Style::points;
  return series;
}

/// Measured and published points, common to both kinds of frequency plot; x as `at` says.
template <class X>
void add_points(Plot& plot, const CampaignTest& test, const std::vector<ModalState>& states, X at) {
  int variant = 2;
  std::size_t k = 0;
  for (const auto& [label, column] : published_models(test)) {
    auto series = points_of(label + " (published model)", Origin::published_model, variant++);
    for (const auto& state : states) {
      for (std::size_t i = 0; i < state.rows.size(); ++i) {
        if (state.rows[i].models_hz.size() <= k || !std::isfinite(state.rows[i].models_hz[k])) {
          continue;
        }
        series.x.push_back(at(state, i));
        series.y.push_back(state.rows[i].models_hz[k]);
      }
    }
    plot.series.push_back(std::move(series));
    ++k;
  }
  for (const Origin origin : {Origin::published, Origin::measured, Origin::synthetic}) {
    auto series = points_of(
        fmt::format("test ({})", origin == Origin::published ? "published" : name_of(origin)),
        origin, 1);
    for (const auto& state : states) {
      for (std::size_t i = 0; i < state.rows.size(); ++i) {
        const auto& row = state.rows[i];
        if (row.origin != origin || !std::isfinite(row.measured_hz)) continue;
        series.x.push_back(at(state, i));
        series.y.push_back(row.measured_hz);
        if (origin == Origin::published) continue;
        series.low.push_back(row.measured_hz - 1.96 * row.std_hz);
        series.high.push_back(row.measured_hz + 1.96 * row.std_hz);
      }
    }
    if (!series.x.empty()) plot.series.push_back(std::move(series));
  }
}

}  // namespace

TensionPlot tension_plot(const CampaignTest& test, const ident::SceneUse& use,
                         const ident::KnownValues& known, const std::vector<ModalState>& states) {
  TensionPlot result;
  Plot& plot = result.plot;
  plot.id = test.name + "-frequency";
  plot.title = "Natural frequencies against tension";
  plot.caption =
      "Lines: the model, in plane (full) and out of plane (broken), each mode followed by its "
      "shape. Where lines cross (×), the order of the modes changes, which is why rows of a table "
      "must not be compared by number.";
  plot.x_label = "tension, N";
  plot.y_label = "frequency, Hz";
  double highest = 0;
  for (const auto& state : states) {
    for (const auto& row : state.rows) {
      if (row.measured_hz > highest) highest = row.measured_hz;
    }
  }
  const auto followed = ident::follow_modes(
      [&](double tension_N) { return ident::scene_at(use, known, tension_N).scene; },
      *states.front().tension_N, *states.back().tension_N, kSteps, 1.1 * highest);
  const auto name_of_line = [&](std::size_t l) {
    const auto& line = followed.lines[l];
    return fmt::format("{} {}", line.plane == model::ModePlane::in ? "in" : "out", line.number);
  };
  for (std::size_t l = 0; l < followed.lines.size(); ++l) {
    const auto& line = followed.lines[l];
    const bool in = line.plane == model::ModePlane::in;
    PlotSeries series;
    series.name = "rigfit " + name_of_line(l);
    series.group = in ? "rigfit, in plane" : "rigfit, out of plane";
    series.style = in ? PlotSeries::Style::line : PlotSeries::Style::dashed;
    const auto begin = followed.tension_N.begin() + line.first;
    series.x.assign(begin, begin + static_cast<std::ptrdiff_t>(line.frequency_hz.size()));
    series.y = line.frequency_hz;
    plot.series.push_back(std::move(series));
  }
  auto crossings = points_of("crossing of two modes", Origin::modelled, 4);
  for (const auto& crossing : followed.crossings) {
    crossings.x.push_back(crossing.tension_N);
    crossings.y.push_back(crossing.frequency_hz);
    result.crossings.push_back(
        {{"tension_N", crossing.tension_N},
         {"frequency_hz", crossing.frequency_hz},
         {"modes", {name_of_line(crossing.one), name_of_line(crossing.other)}}});
  }
  if (!crossings.x.empty()) plot.series.push_back(std::move(crossings));
  add_points(plot, test, states,
             [](const ModalState& state, std::size_t) { return *state.tension_N; });
  return result;
}

Plot row_plot(const CampaignTest& test, const std::vector<ModalState>& states) {
  Plot plot;
  plot.id = test.name + "-frequency";
  plot.title = "Natural frequencies";
  plot.caption = "Measured, published and modelled frequencies, in the order of the table below.";
  plot.x_label = "row of the table";
  plot.y_label = "frequency, Hz";
  plot.log_y = true;
  auto series = points_of("rigfit", Origin::modelled, 0);
  for (std::size_t i = 0; i < states.front().rows.size(); ++i) {
    const auto& row = states.front().rows[i];
    if (!row.mode) continue;
    series.x.push_back(static_cast<double>(i + 1));
    series.y.push_back(states.front().analysis.modes[*row.mode].frequency_hz);
  }
  add_points(plot, test, states,
             [](const ModalState&, std::size_t i) { return static_cast<double>(i + 1); });
  plot.series.push_back(std::move(series));
  return plot;
}

}  // namespace rigfit::apps
