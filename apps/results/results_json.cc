#include "apps/results/results_json.h"

#include <cmath>
#include <fstream>

#include "apps/describe/json_of.h"
#include "model/scene/scene_error.h"

namespace rigfit::apps {
namespace {

// EI(T) as a model takes it, at the tensions of the tests.
Json curve_json(const ident::StiffnessCurve& curve) {
  const bool one_law = curve.source() == ident::StiffnessSource::law;
  const auto point = [&](const auto& one) -> Json {
    const auto at = curve.at(one.tension_N);
    const describe::Bounded EI{at.EI_Nm2, at.std, at.low, at.high};
    return {{"tension_N", one.tension_N}, {"EI_Nm2", describe::json_of(EI)}};
  };
  return {{"source", ident::name_of(curve.source())},
          {"sentence", curve.sentence()},
          {"law", one_law ? Json(ident::name_of(curve.laws().laws.front().kind)) : Json(nullptr)},
          {"points", describe::json_list(curve.points(), point)}};
}

}  // namespace

Json axial_json(const ident::AxialCampaignResult& result) {
  Json out = result.test ? describe::json_of(*result.test) : Json::object();
  out["samples"] = describe::json_of(result.decays);
  return out;
}

Json bending_json(const ident::BendingCampaign& campaign,
                  const ident::BendingCampaignResult& result) {
  const auto& laws = result.curve.laws();
  Json json{{"tests", describe::json_of(result.points)},
            {"laws", describe::json_of(laws.laws)},
            {"bounds", describe::json_of(result.bounds)}};
  if (!laws.laws.empty() || !laws.sentence.empty()) {
    json["law_choice"] = {{"decided", laws.decided}, {"sentence", laws.sentence}};
  }
  if (!result.curve.empty()) json["curve"] = curve_json(result.curve);
  if (result.specimens) json["specimens"] = describe::json_of(*result.specimens);
  if (campaign.assumed_relative_std > 0) {
    json["assumed_relative_std"] = campaign.assumed_relative_std;
  }
  return json;
}

Json hits_json(const ident::StruckPlace& place, const signal::ImpactTest& test) {
  Json hits = Json::array();
  for (const signal::Hit& hit : test.search.hits) {
    hits.push_back({{"file", place.recordings[hit.recording].path.string()}});
    hits.back().update(describe::json_of(hit));
  }
  return hits;
}

Json read_document(const std::filesystem::path& path, const char* key, const char* by) {
  std::ifstream file(path, std::ios::binary);
  Json json = Json::parse(file, nullptr, false);
  if (json.is_object() && json.contains(key)) return json;
  throw model::SceneError({path.string(), 0, 0, key}, "is no such result",
                          std::string("give what ") + by + " wrote");
}

double number_in(const Json& object, const char* key) {
  const bool there = object.is_object() && object.contains(key) && object[key].is_number();
  return there ? object[key].get<double>() : std::nan("");
}

}  // namespace rigfit::apps
