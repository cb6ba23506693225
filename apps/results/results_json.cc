#include "apps/results/results_json.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <optional>

#include "apps/cli/json_document.h"
#include "apps/describe/json_of.h"
#include "ident/campaign/fit_campaign.h"
#include "ident/update/update_rows.h"

namespace rigfit::apps {
namespace {

// EI(T) as a model takes it, at the tensions of the tests.
Json curve_json(const ident::StiffnessCurve& curve) {
  const bool one_law = curve.source() == ident::StiffnessSource::law;
  Json json{{"source", ident::name_of(curve.source())},
            {"sentence", curve.sentence()},
            {"law", one_law ? Json(ident::name_of(curve.laws().laws.front().kind)) : Json(nullptr)},
            {"points", Json::array()}};
  for (const auto& point : curve.points()) {
    const auto at = curve.at(point.tension_N);
    const describe::Bounded EI{at.EI_Nm2, at.std, at.low, at.high};
    json["points"].push_back({{"tension_N", point.tension_N}, {"EI_Nm2", describe::json_of(EI)}});
  }
  return json;
}

}  // namespace

Json axial_json(const ident::AxialInputs& inputs, const ident::AxialCampaignResult& result) {
  Json out = result.test ? describe::json_of(*result.test) : Json::object();
  out["samples"] = describe::json_of(ident::axial_records(inputs, result));
  return out;
}

Json bending_json(const ident::BendingCampaign& campaign,
                  const ident::BendingCampaignResult& result) {
  const auto& laws = result.curve.laws();
  Json json{{"tests", describe::json_of(bending_rows(campaign, result))},
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

Json tension_json(const ident::TensionCampaignResult& campaign) {
  Json json = describe::json_of(campaign.tension);
  if (!campaign.peaks.empty()) json["peaks"] = describe::json_of(campaign.peaks);
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

namespace {

Json pairs_json(const std::vector<ident::UpdatedPair>& paired,
                const std::vector<ident::UpdatedUnpaired>& unpaired, const States& states) {
  return describe::json_of(ident::pair_rows(paired, unpaired, states));
}

Json alternatives_json(const ident::UpdateResult& result, const States& states) {
  Json list = Json::array();
  for (const auto& one : result.alternatives) {
    list.push_back({{"weight", one.weight},
                    {"log_evidence", one.log_evidence},
                    {"log_detected", one.log_detected},
                    {"log_false", one.log_false},
                    {"log_missed", one.log_missed},
                    {"model_std", one.model_std},
                    {"parameters", describe::json_of(one.parameters)},
                    {"pairs", pairs_json(one.pairs, one.unpaired, states)},
                    {"rms_relative_error", one.rms_relative_error}});
  }
  return list;
}

}  // namespace

Json update_json(const ident::UpdateResult& result, const States& states) {
  Json json{{"status", ident::name_of(result.status)},
            {"parameters", describe::json_of(result.parameters)},
            {"fit", describe::json_of(result.fit)},
            {"alternatives", alternatives_json(result, states)},
            {"log_evidence", result.log_evidence}};
  json["correlation"] = describe::json_of(result.correlation);
  json["rank"] = result.identifiability.rank;
  json["condition"] = result.identifiability.condition;
  json["not_identifiable"] = result.open;
  json["pairs"] = pairs_json(result.pairs, result.unpaired, states);
  json["rms_relative_error"] = result.rms_relative_error;
  json["rms_relative_error_before"] = result.rms_relative_error_before;
  json["chi_squared"] = result.chi_squared;
  json["degrees_of_freedom"] = result.degrees_of_freedom;
  json["coverage_factor"] = result.coverage_factor;
  json["starts"] = result.starts;
  json["model_evaluations"] = result.model_evaluations;
  if (result.frf_lines > 0) {
    json["frf_lines"] = result.frf_lines;
    json["rms_log_frf_error"] = result.rms_log_frf_error;
    json["rms_log_frf_error_before"] = result.rms_log_frf_error_before;
  }
  return json;
}

Json held_out_json(const std::vector<ident::HeldOut>& held, const States& states) {
  Json json = Json::array();
  for (const auto& one : held) {
    json.push_back({{"state", states[static_cast<std::size_t>(one.state)].name},
                    {"status", ident::name_of(one.status)},
                    {"rms_relative_error_before", one.rms_before},
                    {"rms_relative_error_fitted", one.rms_fitted},
                    {"rms_relative_error_predicted", one.rms_predicted},
                    {"rms_log_frf_error_before", one.frf_before},
                    {"rms_log_frf_error_fitted", one.frf_fitted},
                    {"rms_log_frf_error_predicted", one.frf_predicted},
                    {"pairs", pairs_json(one.pairs, {}, states)}});
  }
  return json;
}

}  // namespace rigfit::apps
