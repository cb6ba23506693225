#include "apps/report/modal/modal_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/figures/figures.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;

PlotSeries::Style style_of(std::size_t version, std::size_t versions) {
  // The last version is what the report stands for; those before it are broken lines.
  return version + 1 < versions ? PlotSeries::Style::dashed : PlotSeries::Style::line;
}

/// Sensors have a colour each; a single one leaves the colours to the versions.
int colour_of(std::size_t version, std::size_t column, std::size_t columns) {
  return static_cast<int>(columns > 1 ? column : version + 1);
}

}  // namespace

Plot frf_overlay_plot(const std::string& id, const ident::ModalTestState& recorded,
                      const Instrumented& rig, const std::vector<ModelVersion>& versions) {
  const auto compared = ident::compare_frfs(recorded, versions);
  const auto& frfs = compared.test;
  // An exponential window lowers every peak of the measured FRFs; the model has none. Then the test
  // is shown by its identified modes, from which the window's damping has been taken.
  const bool windowed = compared.rebuilt;
  Plot plot = magnitude_plot(id, frfs, {0, frfs.frequency_hz.size() - 1}, recorded.origin, nullptr);
  plot.title = "Frequency response, test and model";
  plot.caption =
      std::string(windowed ? "The test, rebuilt from its modes so that the window's damping "
                             "is out of it,"
                           : "The test's average with its 95 % band,") +
      " and what the model answers to the same force. Peaks side by side: the frequency is "
      "off; peaks of another height: the damping is.";
  for (auto& series : plot.series) series.name += windowed ? ", test (no window)" : ", test";
  const auto& lines = compared.lines_hz;
  for (std::size_t v = 0; v < versions.size(); ++v) {
    const auto& model = compared.versions[v];
    if (model.H.empty()) continue;
    for (std::size_t s = 0; s < rig.response.size(); ++s) {
      for (std::size_t l = 0; l < rig.input.size(); ++l) {
        PlotSeries series;
        series.name = frf_name(frfs, rig.response[s], rig.input[l]) + ", " + versions[v].label;
        series.group = versions[v].label;
        series.origin = Origin::modelled;
        series.style = style_of(v, versions.size());
        series.variant =
            colour_of(v, s * rig.input.size() + l, rig.response.size() * rig.input.size());
        for (Index k = 0; k < lines.size(); ++k) {
          series.x.push_back(lines[k]);
          series.y.push_back(std::abs(
              model.H[static_cast<std::size_t>(k)](static_cast<Index>(s), static_cast<Index>(l))));
        }
        plot.series.push_back(std::move(series));
      }
    }
  }
  return plot;
}

ModelCost response_cost(const std::string& what, const model::ResponseResult& result) {
  ModelCost cost;
  cost.what = what;
  cost.method = fmt::format("{}, {}, {} unknowns, {} steps", name_of(result.solver), result.motion,
                            result.unknowns, result.steps);
  cost.choices = result.nonlinear
                     ? fmt::format("large motion: frequency shifts by about {:.2g} %",
                                   100 * result.frequency_shift)
                     : fmt::format("linear: motion shifts the frequency by about {:.1g} %",
                                   100 * result.frequency_shift);
  for (const auto& left : result.left_out) {
    cost.choices += fmt::format("; left out {} ({:.1g})", left.what, left.relative_error);
  }
  cost.wall_s = result.wall_s;
  cost.relative_error = !result.nonlinear              ? result.frequency_shift
                        : !(result.energy.kinetic > 0) ? std::numeric_limits<double>::quiet_NaN()
                                                       : std::abs(result.energy_drift);
  return cost;
}

}  // namespace rigfit::apps
