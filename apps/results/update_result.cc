#include "apps/results/update_result.h"

#include <fmt/format.h>

#include <cmath>

#include "apps/cli/json_document.h"
#include "apps/describe/sheet.h"
#include "ident/campaign/fit_campaign.h"
#include "ident/update/update_rows.h"

namespace rigfit::apps {
namespace {

// Where each parameter's uncertainty comes from, as shares of its variance; what is below half a
// percent is not shown.
void print_budget(std::ostream& out, const ident::UpdateResult& result) {
  for (const auto& p : result.parameters) {
    std::string shares;
    for (const auto& term : p.budget) {
      const double share = std::pow(term.std / p.std, 2);
      if (!(share > 0.005)) continue;
      shares += fmt::format("{}{} {:.0f} %", shares.empty() ? "" : ", ", term.source, 100 * share);
    }
    if (!shares.empty() && p.budget.size() > 1) {
      out << fmt::format("  variance of {}: {}\n", p.name, shares);
    }
  }
}

Json pairs_json(const std::vector<ident::UpdatedPair>& paired,
                const std::vector<ident::UpdatedUnpaired>& unpaired, const States& states) {
  return describe::json_of(ident::pair_rows(paired, unpaired, states));
}

Json exact_inputs_json(const ident::UpdateResult& result) {
  Json list = Json::array();
  for (const auto& input : result.exact_inputs) {
    Json shifts = Json::object();
    for (std::size_t p = 0; p < result.parameters.size(); ++p) {
      shifts[result.parameters[p].name] = input.shift[static_cast<Eigen::Index>(p)];
    }
    list.push_back({{"name", input.name},
                    {"relative_change", input.relative_change},
                    {"changes", std::move(shifts)}});
  }
  return list;
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
  json["exact_inputs"] = exact_inputs_json(result);
  json["exact_ends"] = result.exact_ends;
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

std::string percent(double ratio) {
  return std::isfinite(ratio) ? fmt::format("{:.2f} %", 100 * ratio) : "-";
}

void print_update(std::ostream& out, const ident::UpdateResult& result, const States& states) {
  if (result.fit.ruled_out())
    out << "the data rule this model out: " << ident::fit_text(result.fit) << '\n';
  describe::print(out, describe::table_of(result.parameters));
  print_budget(out, result);
  describe::print(out, describe::table_of(ident::pair_rows(result.pairs, result.unpaired, states)));
  if (!result.pairs.empty()) {
    out << fmt::format("rms of the paired errors: {} before, {} fitted\n",
                       percent(result.rms_relative_error_before),
                       percent(result.rms_relative_error));
  }
  out << "fit: " << ident::fit_text(result.fit) << '\n';
  if (result.alternatives.size() > 1) {
    out << fmt::format("this answer has a weight of {:.3f}; others that the data support:\n",
                       result.alternatives.front().weight);
    for (const auto& text : ident::alternative_texts(result)) out << "  " << text << '\n';
  }
  if (result.frf_lines > 0) {
    out << fmt::format(
        "rms of |ln(model / measured)| over {} FRF lines: {:.3f} before, {:.3f} fitted\n",
        result.frf_lines, result.rms_log_frf_error_before, result.rms_log_frf_error);
  }
  for (const auto& text : ident::exact_input_texts(result)) out << "  " << text << '\n';
}

}  // namespace rigfit::apps
