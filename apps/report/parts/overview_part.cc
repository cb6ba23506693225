#include "apps/report/parts/parts.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/report/drawing/html_text.h"
#include "apps/report/drawing/rig_drawing.h"
#include "apps/report/page/parameter_words.h"
#include "model/scene/parameters.h"

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
  Plot plot{"model-against-test",
            "Model against test, all modes",
            "Frequency error of the model, all matched modes.",
            "measured frequency, Hz",
            "model over test, %",
            true};
  for (const auto& part : parts) {
    for (const auto& mode : part.modes) {
      if (!(mode.measured_hz > 0 && mode.model_hz > 0)) continue;
      auto at = std::find_if(plot.series.begin(), plot.series.end(),
                             [&](const PlotSeries& one) { return one.name == mode.label; });
      if (at == plot.series.end()) {
        plot.series.push_back({mode.label, mode.origin, static_cast<int>(plot.series.size()),
                               PlotSeries::Style::points});
        at = plot.series.end() - 1;
      }
      at->add(mode.measured_hz, 100 * (mode.model_hz / mode.measured_hz - 1));
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

ReportPart scenes_part(const Campaign& campaign) {
  ReportPart part;
  part.id = "scenes";
  part.title = "What the model was given";
  part.json_key = "scenes";
  ReportTable table{"scene-values",
                    "Values of the scenes, and how each is known.",
                    {{"scene", {}, false},
                     {"value of", {}, false},
                     {"value"},
                     {"unit", {}, false},
                     {"known", {}, false},
                     {"how", {}, false}}};
  Json scenes = Json::array();
  int inferred = 0, assumed = 0;
  for (const auto& scene : campaign.scenes) {
    bool first = true;
    Json values = Json::array();
    for (const auto& origin : scene.origins) {
      const double value = model::parameter(scene.scene, origin.parameter);
      inferred += origin.kind == ValueOrigin::Kind::inferred;
      assumed += origin.kind == ValueOrigin::Kind::assumed;
      Cell known = name_of(origin.kind);
      if (origin.kind == ValueOrigin::Kind::published) known.origin = Origin::published;
      known.doubtful = origin.kind == ValueOrigin::Kind::assumed;
      table.rows.push_back({first ? scene.name : "", parameter_words(origin.parameter),
                            fmt::format("{}", value), parameter_unit(scene.scene, origin.parameter),
                            known, origin.how});
      values.push_back({{"parameter", origin.parameter},
                        {"value", value},
                        {"known", name_of(origin.kind)},
                        {"how", origin.how}});
      first = false;
    }
    scenes.push_back({{"name", scene.name}, {"file", scene.file}, {"values", std::move(values)}});
  }
  part.json = std::move(scenes);
  if (campaign.scenes.empty()) return part;
  part.blocks.push_back(Paragraph{
      "A model is only as good as what it is given. Published values are stated by the source; "
      "inferred ones were worked out from its tables and are starting values, not truth; assumed "
      "ones are neither, with the reason why they hardly matter here."});
  if (!table.rows.empty()) part.blocks.push_back(std::move(table));
  if (inferred + assumed > 0) {
    part.warnings.push_back(
        {"read_as",
         fmt::format("{} of the model are not measured but inferred ({}) or assumed ({}); each is "
                     "listed with how",
                     counted(static_cast<std::size_t>(inferred + assumed), "value"), inferred,
                     assumed),
         ""});
  }
  return part;
}

}  // namespace rigfit::apps
