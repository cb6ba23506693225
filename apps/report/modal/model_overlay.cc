#include "apps/report/modal/model_overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/figures/frf_plots.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;

PlotSeries::Style style_of(std::size_t version, std::size_t versions) {
  // The last version is what the report stands for; those before it are broken lines.
  return version + 1 < versions ? PlotSeries::Style::dashed : PlotSeries::Style::line;
}

int shade_of(std::size_t version, std::size_t versions) {
  return version + 1 == versions ? 0 : version == 0 ? 2 : 1;
}

const char* axis_of(signal::FrfForm form) {
  switch (form) {
    case signal::FrfForm::receptance:
      return "displacement, m";
    case signal::FrfForm::mobility:
      return "velocity, m/s";
    default:
      return "acceleration, m/s²";
  }
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
        series.variant = shade_of(v, versions.size());
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
                        : result.energy.time_s.empty() ? std::numeric_limits<double>::quiet_NaN()
                                                       : std::abs(result.energy_drift);
  return cost;
}

std::vector<Plot> hit_overlay_plots(const std::string& id, const ident::ModalTestState& recorded,
                                    const Instrumented& rig,
                                    const std::vector<ModelVersion>& versions,
                                    std::vector<ModelCost>& costs) {
  if (recorded.hits.empty() || rig.response.empty() || rig.input.empty()) return {};
  const auto load = static_cast<std::size_t>(rig.input.front());
  const ident::RecordedHit& hit = recorded.hits[load];
  const Index n = hit.force.size();
  if (n < 2) return {};
  Plot plot;
  plot.id = id;
  plot.title = "Answer to one hit, test and model";
  plot.caption =
      "One accepted hit as recorded, and the model's answer to the recorded force. Nothing here "
      "was "
      "fitted to this trace.";
  plot.x_label = "time, s";
  plot.y_label = axis_of(recorded.hammer.frfs.form);
  for (std::size_t s = 0; s < rig.response.size(); ++s) {
    PlotSeries series;
    series.name =
        recorded.hammer.frfs.responses[static_cast<std::size_t>(rig.response[s])].name + ", test";
    series.origin = recorded.origin;
    series.variant = static_cast<int>(s);
    for (Index i = 0; i < n; ++i) {
      series.x.push_back(static_cast<double>(i) / hit.rate_hz);
      series.y.push_back(hit.responses(i, rig.response[s]));
    }
    plot.series.push_back(std::move(series));
  }
  const auto answers = ident::answers_to_hit(hit, versions);
  for (std::size_t v = 0; v < versions.size(); ++v) {
    const auto& result = answers[v];
    if (!result.completed) continue;
    costs.push_back(
        response_cost(fmt::format("{}: answer to a hit, {}", id, versions[v].label), result));
    for (std::size_t s = 0; s < rig.response.size(); ++s) {
      PlotSeries series;
      series.name = versions[v].scene.sensors[s].name + ", " + versions[v].label;
      series.group = versions[v].label;
      series.origin = Origin::modelled;
      series.style = style_of(v, versions.size());
      series.variant = shade_of(v, versions.size());
      const Index rows = std::min<Index>(n, result.samples.rows());
      for (Index i = 0; i < rows; ++i) {
        series.x.push_back(static_cast<double>(i) / hit.rate_hz);
        series.y.push_back(result.samples(i, static_cast<Index>(s)));
      }
      plot.series.push_back(std::move(series));
    }
  }
  // The first moments: the pulse and some 0.25 s after it, as the eye can follow.
  Index peak = 0;
  hit.force.cwiseAbs().maxCoeff(&peak);
  const double from = std::max(0.0, static_cast<double>(peak) / hit.rate_hz - 0.01);
  Plot zoom = plot;
  zoom.id = id + "-first";
  zoom.title = "The first moments of it";
  zoom.caption = "The same, the first quarter of a second after the hit.";
  for (auto& series : zoom.series) {
    PlotSeries cut = series;
    cut.x.clear();
    cut.y.clear();
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (series.x[i] < from || series.x[i] > from + 0.26) continue;
      cut.x.push_back(series.x[i]);
      cut.y.push_back(series.y[i]);
    }
    series = std::move(cut);
  }
  return {std::move(plot), std::move(zoom)};
}

}  // namespace rigfit::apps
