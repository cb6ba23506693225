#include "apps/report/parts/parts.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/report/drawing/rig_drawing.h"

namespace rigfit::apps {
namespace {

/// The scene with most members among those of the tests, else of all.
const model::Scene* largest_scene(const Campaign& campaign) {
  const model::Scene* largest = nullptr;
  const auto take = [&](const model::Scene& scene) {
    if (!largest || scene.members.size() > largest->members.size()) largest = &scene;
  };
  for (const auto& test : campaign.tests) {
    if (test.scene) take(campaign.scenes[*test.scene].scene);
  }
  if (!largest) {
    for (const auto& one : campaign.scenes) take(one.scene);
  }
  return largest;
}

/// Frequencies of the models over those of the tests, every mode of every test.
Plot all_modes_plot(const std::vector<ReportPart>& parts) {
  Plot plot;
  plot.id = "model-against-test";
  plot.title = "Model against test, all modes";
  plot.caption = "Frequency error of the model, all matched modes.";
  plot.x_label = "measured frequency, Hz";
  plot.y_label = "model over test, %";
  plot.log_x = true;
  for (const auto& part : parts) {
    for (const auto& mode : part.modes) {
      if (!(mode.measured_hz > 0 && mode.model_hz > 0)) continue;
      auto at = std::find_if(plot.series.begin(), plot.series.end(),
                             [&](const PlotSeries& one) { return one.name == mode.label; });
      if (at == plot.series.end()) {
        PlotSeries series;
        series.name = mode.label;
        series.origin = mode.origin;
        series.style = PlotSeries::Style::points;
        series.variant = static_cast<int>(plot.series.size());
        at = plot.series.insert(at, std::move(series));
      }
      at->x.push_back(mode.measured_hz);
      at->y.push_back(100 * (mode.model_hz / mode.measured_hz - 1));
    }
  }
  return plot;
}

}  // namespace

ReportPart overview_part(const Campaign& campaign, const std::vector<ReportPart>& parts) {
  ReportPart part;
  part.id = "overview";
  part.title = "Overview";
  if (const auto* scene = largest_scene(campaign)) {
    Picture picture;
    picture.id = "rig-drawing";
    picture.title = "What was tested";
    picture.caption = fmt::format("{}, to scale. S: sensor, H: where it is struck or released.",
                                  scene->title.empty() ? "The rig" : scene->title);
    picture.svg = rig_drawing(*scene);
    picture.csv = rig_places(*scene);
    part.blocks.push_back(std::move(picture));
  }
  if (auto plot = all_modes_plot(parts); !plot.series.empty()) {
    part.blocks.push_back(std::move(plot));
  }
  return part;
}

}  // namespace rigfit::apps
