#include "apps/results/bending_json.h"

#include <cmath>
#include <vector>

#include "apps/cli/json_document.h"
#include "signal/numerics/numbers.h"

namespace rigfit::apps {
namespace {

Json analysis_json(const ident::BendingTestResult& result) {
  Json json;
  json["tension_range_N"] = {json_number(result.tension_low_N), json_number(result.tension_high_N)};
  json["compliance_m_N"] = json_estimate(result.compliance_m_N.value, result.compliance_m_N.std);
  json["degrees_of_freedom"] = result.degrees_of_freedom;
  json["lambda"] = json_number(result.stiffness.lambda);
  json["ratio"] = json_number(result.stiffness.ratio);
  json["log_sensitivity"] = {
      {"compliance", json_number(result.stiffness.log_sensitivity_compliance)},
      {"tension", json_number(result.stiffness.log_sensitivity_tension)},
      {"span", json_number(result.stiffness.log_sensitivity_span)}};
  json["hysteresis_N"] = result.hysteresis_N;
  json["friction"] = {{"probability", result.friction_probability},
                      {"travel_m", result.friction_travel_m},
                      {"load_N", result.friction_load_N},
                      {"relative_std_of_slope", result.relative_std_friction},
                      {"relative_correction_of_slope", result.relative_friction_correction}};
  json["strokes"] = Json::array();
  for (const auto& stroke : result.strokes) {
    json["strokes"].push_back(
        {{"loading", stroke.loading},
         {"samples", {stroke.first, stroke.last}},
         {"used", {stroke.used_first, stroke.used_last}},
         {"stiffness_N_m", json_estimate(stroke.stiffness_N_m.value, stroke.stiffness_N_m.std)},
         {"offset_N", stroke.offset_N},
         {"residual_rms_N", stroke.residual_rms_N},
         {"curvature", stroke.curvature}});
  }
  json["findings"] = Json::array();
  for (const auto& finding : result.findings) {
    json["findings"].push_back(
        {{"code", finding.code}, {"message", finding.message}, {"refuses", finding.refuses}});
  }
  return json;
}

Json law_json(const ident::FittedLaw& law, const std::vector<double>& tensions) {
  Json parameters = Json::array();
  for (const auto& p : law.parameters) {
    parameters.push_back({{"name", p.name},
                          {"value", p.value},
                          {"std", json_number(p.std)},
                          {"unit", p.unit},
                          {"fixed", p.fixed}});
  }
  Json covariance = Json::array();
  for (Eigen::Index i = 0; i < law.covariance.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < law.covariance.cols(); ++j)
      row.push_back(json_number(law.covariance(i, j)));
    covariance.push_back(std::move(row));
  }
  Json json{{"law", ident::name_of(law.kind)},
            {"formula", law.formula},
            {"parameters", std::move(parameters)},
            {"covariance", std::move(covariance)},
            {"aicc", json_number(law.aicc)},
            {"akaike_weight", json_number(law.akaike_weight)},
            {"chi_squared", law.chi_squared},
            {"degrees_of_freedom", law.degrees_of_freedom},
            {"rms_relative_error", law.rms_relative_error},
            {"converged", law.converged}};
  if (!law.message.empty()) json["message"] = law.message;
  json["predictions"] = Json::array();
  for (double tension : tensions) {
    const auto at = ident::predict(law, tension);
    json["predictions"].push_back({{"tension_N", tension},
                                   {"EI_Nm2", at.EI_Nm2},
                                   {"low", json_number(at.low)},
                                   {"high", json_number(at.high)},
                                   {"test_low", json_number(at.test_low)},
                                   {"test_high", json_number(at.test_high)}});
  }
  return json;
}

// EI(T) as a model takes it.
Json curve_json(const ident::StiffnessCurve& curve, const std::vector<double>& tensions) {
  Json json{{"source", ident::name_of(curve.source())}, {"sentence", curve.sentence()}};
  json["law"] = curve.source() == ident::StiffnessSource::law
                    ? Json(ident::name_of(curve.laws().laws.front().kind))
                    : Json(nullptr);
  json["points"] = Json::array();
  for (const double tension : tensions) {
    const auto at = curve.at(tension);
    json["points"].push_back({{"tension_N", tension},
                              {"EI_Nm2",
                               {{"value", at.EI_Nm2},
                                {"std", json_number(at.std)},
                                {"low", json_number(at.low)},
                                {"high", json_number(at.high)}}}});
  }
  json["budget"] = Json::array();
  for (const auto& term : curve.uncertainty(tensions)) {
    json["budget"].push_back(
        {{"source", term.name},
         {"change_Nm2", std::vector<double>(term.change_Nm2.begin(), term.change_Nm2.end())}});
  }
  const Eigen::MatrixXd covariance = curve.covariance(tensions);
  json["covariance"] = Json::array();
  if (!covariance.allFinite()) return json;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < covariance.cols(); ++j) row.push_back(covariance(i, j));
    json["covariance"].push_back(std::move(row));
  }
  return json;
}

}  // namespace

Json bending_point_json(const ident::BendingCampaign& campaign, const ident::BendingPoint& one) {
  const auto& point = one.point;
  const bool refused = one.refused();
  const auto unless_refused = [&](double x) { return refused ? Json(nullptr) : json_number(x); };
  Json json{{"file", campaign.sources[one.source].name},
            {"tension_N", json_number(point.tension_N)},
            {"EI_Nm2",
             {{"value", unless_refused(point.EI_Nm2)},
              {"std", unless_refused(point.std)},
              {"low", unless_refused(point.low)},
              {"high", unless_refused(point.high)}}},
            {"refused", refused}};
  if (one.row > 0) json["row"] = one.row;
  json["shared_relative_std"] = point.shared_relative_std;
  json["tension_spread_N"] = point.tension_std_N;
  if (one.analysis) json.update(analysis_json(*one.analysis));
  if (!one.analysis || one.analysis->ends == ident::BeamEnds::tensioned) return json;
  const auto& compliance = one.analysis->compliance_m_N;
  json["ends"] = ident::name_of(one.analysis->ends);
  json["stiffness_N_m"] = refused
                              ? json_estimate(signal::kNaN, signal::kNaN)
                              : json_estimate(1 / compliance.value,
                                              compliance.std / compliance.value / compliance.value);
  const auto modulus = ident::bending_modulus(campaign, one);
  if (campaign.second_moment_m4.value > 0) {
    json["modulus_Pa"] = json_estimate(modulus.value, modulus.std);
  }
  return json;
}

Json bending_json(const ident::BendingCampaign& campaign,
                  const ident::BendingCampaignResult& result) {
  Json json;
  json["tests"] = Json::array();
  for (const auto& one : result.points) json["tests"].push_back(bending_point_json(campaign, one));
  json["laws"] = Json::array();
  std::vector<double> tensions;
  for (const auto& point : result.curve.points()) tensions.push_back(point.tension_N);
  const auto& laws = result.curve.laws();
  for (const auto& law : laws.laws) json["laws"].push_back(law_json(law, tensions));
  if (!laws.laws.empty() || !laws.sentence.empty()) {
    json["law_choice"] = {{"decided", laws.decided}, {"sentence", laws.sentence}};
  }
  if (!result.curve.empty()) json["curve"] = curve_json(result.curve, tensions);
  json["bounds"] = nullptr;
  if (result.bounds) {
    json["bounds"] = {{"EI_min_Nm2", result.bounds->EI_min_Nm2},
                      {"EI_max_Nm2", result.bounds->EI_max_Nm2}};
  }
  if (result.specimens) {
    const auto& all = *result.specimens;
    json["specimens"] = {{"count", all.count},
                         {"EI_Nm2", all.EI_Nm2},
                         {"modulus_Pa", json_number(all.modulus_Pa)},
                         {"relative_scatter", all.relative_scatter}};
  }
  if (campaign.assumed_relative_std > 0) {
    json["assumed_relative_std"] = campaign.assumed_relative_std;
  }
  return json;
}

}  // namespace rigfit::apps
