#include "apps/report/parts/parts.h"

#include <fmt/format.h>

#include "apps/report/drawing/html_text.h"
#include "apps/report/page/parameter_words.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/parameters.h"

namespace rigfit::apps {
namespace {

/// As many digits as it was given with.
std::string given_number(double value) {
  std::string text = fmt::format("{}", value);
  if (text.starts_with('-')) text.replace(0, 1, "−");
  return text;
}

}  // namespace

std::string parameter_unit(const model::Scene& scene, const std::string& name) {
  std::string unit = model::parameters_named(scene, {name}).front().unit;
  if (unit == "1") return {};
  for (const auto& [plain, written] :
       {std::pair<std::string, std::string>{"m2", "m²"}, {"s2", "s²"}, {"m3", "m³"}}) {
    if (const auto at = unit.find(plain); at != std::string::npos) {
      unit.replace(at, plain.size(), written);
    }
  }
  return unit;
}

ReportPart scenes_part(const Campaign& campaign) {
  ReportPart part;
  part.id = "scenes";
  part.title = "What the model was given";
  part.json_key = "scenes";
  ReportTable table;
  table.id = "scene-values";
  table.caption = "Values of the scenes, and how each is known.";
  table.columns = {{"scene", {}, false}, {"value of", {}, false}, {"value", {}, true},
                   {"unit", {}, false},  {"known", {}, false},    {"how", {}, false}};
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
                            given_number(value), parameter_unit(scene.scene, origin.parameter),
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
         "", false});
  }
  return part;
}

}  // namespace rigfit::apps
