#include "apps/results/results_json.h"

#include "apps/describe/json_of.h"

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

}  // namespace rigfit::apps
