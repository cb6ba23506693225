#include "apps/report/parts/parts.h"

#include <fmt/format.h>

#include <array>

#include "apps/report/drawing/html_text.h"
#include "apps/report/figures/figures.h"

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
      plot.named(mode.label, mode.origin)
          .add(mode.measured_hz, 100 * (mode.model_hz / mode.measured_hz - 1));
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
    part.blocks.push_back(rig_picture(*scene));
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
  ReportTable table{
      "scene-values", "Values of the scenes, and how each is known.", {{"scene", {}, false}}};
  Json scenes = Json::array();
  std::array<std::size_t, 3> count{};  // by kind
  for (const auto& scene : campaign.scenes) {
    add_rows(table, {scene.name}, describe::table_of(scene.origins), std::nullopt);
    for (const auto& origin : scene.origins) ++count[static_cast<std::size_t>(origin.kind)];
    scenes.push_back(
        {{"name", scene.name}, {"file", scene.file}, {"values", describe::json_of(scene.origins)}});
  }
  part.json = std::move(scenes);
  if (campaign.scenes.empty()) return part;
  part.blocks.push_back(Paragraph{
      "A model is only as good as what it is given. Published values are stated by the source; "
      "inferred ones were worked out from its tables and are starting values, not truth; assumed "
      "ones are neither, with the reason why they hardly matter here."});
  if (!table.rows.empty()) part.blocks.push_back(std::move(table));
  if (count[1] + count[2] > 0) {
    part.warnings.push_back(
        {"read_as",
         fmt::format("{} of the model are not measured but inferred ({}) or assumed ({}); each is "
                     "listed with how",
                     counted(count[1] + count[2], "value"), count[1], count[2]),
         ""});
  }
  return part;
}

}  // namespace rigfit::apps
