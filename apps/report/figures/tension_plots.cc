#include "apps/report/figures/figures.h"

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
    add_modes(frequencies, points_of(name, Origin::modelled, variant + 1), one,
              [](const auto& mode) { return mode.model_hz; });
    add_modes(errors, points_of(name, Origin::modelled, variant), one,
              [](const auto& mode) { return 100 * mode.relative_error; });
    ++variant;
  }
  return {std::move(frequencies), std::move(errors)};
}

}  // namespace rigfit::apps
