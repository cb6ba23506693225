#include "apps/report/parts/overview_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

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

void add_point(PlotSeries& series, const Json& pair, const char* model_key) {
  const auto measured = pair.find("measured_hz"), model = pair.find(model_key);
  if (measured == pair.end() || model == pair.end()) return;
  if (!measured->is_number() || !model->is_number()) return;
  series.x.push_back(measured->get<double>());
  series.y.push_back(100 * (model->get<double>() / measured->get<double>() - 1));
}

/// Frequencies of the models over those of the tests, every mode of every test.
Plot all_modes_plot(const std::vector<ReportPart>& parts) {
  Plot plot;
  plot.id = "model-against-test";
  plot.title = "Model against test, all modes";
  plot.caption =
      "How far a model's natural frequency lies above the measured one, every paired mode.";
  plot.x_label = "measured frequency, Hz";
  plot.y_label = "model over test, %";
  plot.log_x = true;
  PlotSeries given, fitted;
  given.name = "model as given";
  given.variant = 2;
  fitted.name = "model fitted";
  given.origin = fitted.origin = Origin::modelled;
  given.style = fitted.style = PlotSeries::Style::points;
  std::map<std::string, PlotSeries> published;
  for (const auto& part : parts) {
    if (part.json_key == "modal") {
      for (const auto& state : part.json["states"]) {
        for (const auto& pair : state["pairs"]) {
          if (pair.value("other_plane", false)) continue;
          add_point(given, pair, "model_hz");
          for (const auto& [label, value] : pair["published_hz"].items()) {
            auto& series = published[label];
            if (!value.is_number() || !pair["measured_hz"].is_number()) continue;
            series.x.push_back(pair["measured_hz"].get<double>());
            series.y.push_back(100 * (value.get<double>() / series.x.back() - 1));
          }
        }
      }
    } else if (part.json_key == "fits" && part.json.contains("pairs")) {
      for (const auto& pair : part.json["pairs"]) {
        if (!pair.value("leakage", false)) add_point(fitted, pair, "model_hz");
      }
    }
  }
  int variant = 0;
  for (auto& [label, series] : published) {
    if (series.x.empty()) continue;
    series.name = "published model, " + label;
    series.origin = Origin::published_model;
    series.style = PlotSeries::Style::points;
    series.variant = variant++;
    plot.series.push_back(std::move(series));
  }
  for (auto* series : {&given, &fitted}) {
    if (!series->x.empty()) plot.series.push_back(std::move(*series));
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
