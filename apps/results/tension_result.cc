#include "apps/results/tension_result.h"

#include <fmt/format.h>

#include <vector>

#include "apps/cli/digits.h"
#include "apps/cli/json_document.h"
#include "ident/statistics/probability_text.h"

namespace rigfit::apps {
namespace {

Json interval_json(const signal::Estimate& estimate, double low, double high) {
  Json json = json_estimate(estimate.value, estimate.std);
  json["low"] = json_number(low);
  json["high"] = json_number(high);
  return json;
}

Json modes_json(const std::vector<ident::TensionMode>& modes) {
  Json list = Json::array();
  for (const auto& mode : modes) {
    list.push_back({{"order", mode.order > 0 ? Json(mode.order) : Json(nullptr)},
                    {"plane", mode.order > 0 ? Json(model::name_of(mode.plane)) : Json(nullptr)},
                    {"measured_hz", mode.measured_hz},
                    {"measured_std_hz", json_number(mode.measured_std_hz)},
                    {"model_hz", json_number(mode.model_hz)},
                    {"relative_error", json_number(mode.relative_error)}});
  }
  return list;
}

Json candidate_json(const ident::TensionCandidate& one) {
  Json json{{"ends", ident::name_of(one.ends)}, {"solved", one.solved}, {"weight", one.weight}};
  if (!one.message.empty()) json["message"] = one.message;
  if (!one.solved) return json;
  json["tension_N"] = interval_json(one.tension_N, one.low, one.high);
  json["EI_Nm2"] = json_estimate(one.EI_Nm2.value, one.EI_Nm2.std);
  if (one.ends == ident::CableEnds::springs) {
    json["spring_Nm_rad"] = json_estimate(one.spring_Nm_rad.value, one.spring_Nm_rad.std);
  }
  json["chi2"] = json_number(one.fit.chi2);
  json["degrees_of_freedom"] = one.fit.degrees_of_freedom;
  json["p_value"] = json_number(one.fit.p_value);
  json["model_std"] = one.fit.model_std;
  json["missed_modes"] = one.missed;
  json["modes"] = modes_json(one.modes);
  return json;
}

}  // namespace

Json tension_json(const ident::TensionInputs& inputs,
                  const ident::TensionCampaignResult& campaign) {
  Json json = tension_json(campaign.result.tension);
  for (const auto& one : campaign.peaks) {
    const auto& peak = one.peak;
    json["peaks"].push_back(
        {{"file", inputs.recordings[one.recording].name},
         {"channel", one.channel},
         {"frequency_hz", json_estimate(peak.frequency_hz.value, peak.frequency_hz.std)},
         {"half_power_bandwidth_hz", json_number(peak.bandwidth_hz)},
         {"signal_to_noise", json_number(peak.signal_to_noise)},
         {"possible_tone", peak.undecided}});
  }
  for (const auto& one : campaign.tones) {
    json["steady_tones"].push_back({{"file", inputs.recordings[one.recording].name},
                                    {"channel", one.channel},
                                    {"frequency_hz", json_number(one.tone.frequency_hz)},
                                    {"amplitude", json_number(one.tone.amplitude)},
                                    {"reach_hz", json_number(one.tone.reach_hz)}});
  }
  return json;
}

Json tension_json(const ident::TensionResult& result) {
  const auto& best = result.candidates.front();
  Json json{{"tension_N", interval_json(result.tension_N, result.low, result.high)},
            {"tension_start_N", json_number(result.start_N)},
            {"tension_end_N", json_number(result.end_N)},
            {"EI_Nm2", json_estimate(result.EI_Nm2.value, result.EI_Nm2.std)},
            {"ends", ident::name_of(best.ends)},
            {"sag_m", json_number(result.sag_m)},
            {"irvine_parameter", json_number(result.irvine_parameter)},
            {"bending_parameter", json_number(result.bending_parameter)},
            {"decided", result.decided}};
  json["candidates"] = Json::array();
  for (const auto& one : result.candidates) json["candidates"].push_back(candidate_json(one));
  json["modes"] = modes_json(best.modes);
  json["formulas"] = {{"string_N", json_number(result.formulas.string_N)},
                      {"pinned_beam_N", json_number(result.formulas.pinned_beam_N)},
                      {"clamped_beam_N", json_number(result.formulas.clamped_beam_N)},
                      {"zui_N", json_number(result.formulas.zui_N)}};
  json["budget"] = Json::array();
  for (const auto& term : result.budget) {
    json["budget"].push_back({{"source", term.source}, {"std_N", json_number(term.std)}});
  }
  return json;
}

void print_tension(std::ostream& out, const ident::TensionResult& result) {
  const auto& best = result.candidates.front();
  const double std = result.tension_N.std;
  const auto known = [std](double value) { return value_digits(value, std); };
  out << fmt::format("tension {} N at mid-span, std {} N, 95 % interval {} to {} N\n",
                     known(result.tension_N.value), std_digits(std), known(result.low),
                     known(result.high));
  out << fmt::format("        {} N at the first end, {} N at the second; sag {:.3g} m\n",
                     known(result.start_N), known(result.end_N), result.sag_m);
  out << fmt::format("EI      {} N m2, std {}\n\n",
                     value_digits(result.EI_Nm2.value, result.EI_Nm2.std),
                     std_digits(result.EI_Nm2.std));
  out << fmt::format("{:<10} {:>8} {:>14} {:>10} {:>10} {:>5} {:>10}\n", "ends", "weight",
                     "tension, N", "std", "chi2", "dof", "p");
  for (const auto& one : result.candidates) {
    if (!one.solved) {
      out << fmt::format("{:<10} {}\n", ident::name_of(one.ends), one.message);
      continue;
    }
    out << fmt::format("{:<10} {:>8.3f} {:>14} {:>10} {:>10.3g} {:>5.3g} {:>10}\n",
                       ident::name_of(one.ends), one.weight,
                       value_digits(one.tension_N.value, one.tension_N.std),
                       std_digits(one.tension_N.std), one.fit.chi2, one.fit.degrees_of_freedom,
                       ident::probability_text(one.fit.p_value));
  }
  out << fmt::format("\n{:>5} {:>6} {:>13} {:>13} {:>10}\n", "order", "plane", "measured, Hz",
                     "model, Hz", "error");
  for (const auto& mode : best.modes) {
    if (mode.order == 0) {
      out << fmt::format("{:>5} {:>6} {:>13.6g} {:>13}\n", "-", "-", mode.measured_hz, "none");
      continue;
    }
    out << fmt::format("{:>5} {:>6} {:>13.6g} {:>13.6g} {:>8.3f} %\n", mode.order,
                       model::name_of(mode.plane), mode.measured_hz, mode.model_hz,
                       100 * mode.relative_error);
  }
  out << fmt::format(
      "\nFormulas from the lowest mode: string {:.6g} N, pinned beam {:.6g} N, clamped beam {:.6g} "
      "N, "
      "Zui {:.6g} N\n",
      result.formulas.string_N, result.formulas.pinned_beam_N, result.formulas.clamped_beam_N,
      result.formulas.zui_N);
}

}  // namespace rigfit::apps
