#include "apps/results/update_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/cli/json_document.h"
#include "apps/describe/digits.h"
#include "ident/campaign/fit_campaign.h"
#include "signal/numerics/numbers.h"

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

Json spread_json(const Eigen::VectorXd& mean, const Eigen::VectorXd& std,
                 const Eigen::VectorXd& low, const Eigen::VectorXd& high, Eigen::Index j) {
  if (j >= mean.size()) return nullptr;
  return {{"mean", mean[j]}, {"std", std[j]}, {"low", low[j]}, {"high", high[j]}};
}

}  // namespace

Json pair_json(const ident::UpdatedPair& pair, const States& states) {
  Json json{{"state", states[static_cast<std::size_t>(pair.state)].name},
            {"measured_hz", pair.measured_hz},
            {"model_hz", pair.model_hz},
            {"relative_error", pair.relative_error},
            {"plane", model::name_of(pair.plane)},
            {"order", pair.order + 1}};
  if (std::isfinite(pair.mac)) json["mac"] = pair.mac;
  if (std::isfinite(pair.measured_damping)) {
    json["measured_damping_ratio"] = pair.measured_damping;
    json["model_damping_ratio"] = json_number(pair.model_damping);
  }
  if (std::isfinite(pair.model_std_hz)) json["model_std_hz"] = pair.model_std_hz;
  if (pair.cross_plane) json["leakage"] = true;
  return json;
}

Json parameters_json(const std::vector<ident::UpdatedParameter>& parameters) {
  Json list = Json::array();
  for (const auto& p : parameters) {
    Json budget = Json::array();
    for (const auto& term : p.budget) {
      budget.push_back({{"source", term.source}, {"std", term.std}});
      if (std::isfinite(term.change)) budget.back()["change"] = term.change;
    }
    list.push_back({{"name", p.name},
                    {"start", p.start},
                    {"value", p.value},
                    {"std", json_number(p.std)},
                    {"low", json_number(p.low)},
                    {"high", json_number(p.high)},
                    {"interval", p.interval_by_profile ? "profile" : "linear"},
                    {"identifiable", p.identifiable},
                    {"std_from_data", json_number(p.std_from_data)},
                    {"at_bound", p.at_bound},
                    {"segment_shift", json_number(p.segment_shift)},
                    {"segments_taken_off", json_number(p.segments_taken_off)},
                    {"budget", std::move(budget)}});
  }
  return list;
}

namespace {

Json pairs_json(const std::vector<ident::UpdatedPair>& paired,
                const std::vector<ident::UpdatedUnpaired>& unpaired, const States& states) {
  Json pairs = Json::array();
  for (const auto& pair : paired) pairs.push_back(pair_json(pair, states));
  for (const auto& lone : unpaired) {
    pairs.push_back({{"state", states[static_cast<std::size_t>(lone.state)].name},
                     {"measured_hz", lone.measured ? Json(lone.frequency_hz) : Json(nullptr)},
                     {"model_hz", lone.measured ? Json(nullptr) : Json(lone.frequency_hz)},
                     {"relative_error", nullptr},
                     {"reason", lone.reason}});
  }
  return pairs;
}

Json fit_json(const ident::UpdateFit& fit) {
  return {{"chi2", fit.chi2},
          {"degrees_of_freedom", fit.degrees_of_freedom},
          {"p_value", json_number(fit.p_value)},
          {"chi2_by_inputs", fit.by_inputs},
          {"uncertainties", fit.stated ? "stated" : "assumed"},
          {"model_std", fit.model_std},
          {"frf_model_std", fit.frf_model_std},
          {"correlated_lines", fit.correlated_lines}};
}

Json exact_inputs_json(const ident::UpdateResult& result) {
  Json list = Json::array();
  for (const auto& input : result.exact_inputs) {
    Json shifts = Json::object();
    for (std::size_t p = 0; p < result.parameters.size(); ++p) {
      shifts[result.parameters[p].name] = json_number(input.shift[static_cast<Eigen::Index>(p)]);
    }
    list.push_back({{"name", input.name},
                    {"relative_change", input.relative_change},
                    {"changes", std::move(shifts)}});
  }
  return list;
}

Json exact_ends_json(const ident::UpdateResult& result) {
  Json list = Json::array();
  for (const auto& ends : result.exact_ends) {
    Json shifts = Json::object(), largest = Json::object();
    for (std::size_t p = 0; p < result.parameters.size(); ++p) {
      const auto& name = result.parameters[p].name;
      shifts[name] = json_number(ends.shift[static_cast<Eigen::Index>(p)]);
      largest[name] = json_number(ends.largest_shift[static_cast<Eigen::Index>(p)]);
    }
    list.push_back({{"nodes", ends.nodes},
                    {"taken_as", ends.taken_as},
                    {"springs_Nm_rad", json_number(ends.stiffness)},
                    {"chi2_less", json_number(ends.chi2_less)},
                    {"changes", std::move(shifts)},
                    {"largest_changes", std::move(largest)}});
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
                    {"parameters", parameters_json(one.parameters)},
                    {"pairs", pairs_json(one.pairs, one.unpaired, states)},
                    {"rms_relative_error", json_number(one.rms_relative_error)}});
  }
  return list;
}

Json correlation_json(const Eigen::MatrixXd& matrix) {
  Json correlation = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row.push_back(json_number(matrix(i, j)));
    correlation.push_back(std::move(row));
  }
  return correlation;
}

}  // namespace

Json update_json(const ident::UpdateResult& result, const States& states) {
  Json json{{"status", ident::name_of(result.status)},
            {"parameters", parameters_json(result.parameters)},
            {"fit", fit_json(result.fit)},
            {"alternatives", alternatives_json(result, states)},
            {"log_evidence", json_number(result.log_evidence)}};
  json["exact_inputs"] = exact_inputs_json(result);
  json["exact_ends"] = exact_ends_json(result);
  json["correlation"] = correlation_json(result.correlation);
  json["rank"] = result.identifiability.rank;
  json["condition"] = json_number(result.identifiability.condition);
  json["not_identifiable"] = result.open;
  json["pairs"] = pairs_json(result.pairs, result.unpaired, states);
  json["rms_relative_error"] = json_number(result.rms_relative_error);
  json["rms_relative_error_before"] = json_number(result.rms_relative_error_before);
  json["chi_squared"] = result.chi_squared;
  json["degrees_of_freedom"] = result.degrees_of_freedom;
  json["coverage_factor"] = result.coverage_factor;
  json["starts"] = result.starts;
  json["starts_agreeing"] = result.starts_agreeing;
  json["model_evaluations"] = result.model_evaluations;
  json["auto_segments"] = result.auto_segments;
  if (result.frf_lines > 0) {
    json["frf_lines"] = result.frf_lines;
    json["rms_log_frf_error"] = json_number(result.rms_log_frf_error);
    json["rms_log_frf_error_before"] = json_number(result.rms_log_frf_error_before);
  }
  return json;
}

Json held_out_json(const std::vector<ident::HeldOut>& held, const States& states) {
  Json json = Json::array();
  for (const auto& one : held) {
    Json pairs = Json::array();
    for (const auto& pair : one.pairs) pairs.push_back(pair_json(pair, states));
    json.push_back({{"state", states[static_cast<std::size_t>(one.state)].name},
                    {"status", ident::name_of(one.status)},
                    {"rms_relative_error_before", json_number(one.rms_before)},
                    {"rms_relative_error_fitted", json_number(one.rms_fitted)},
                    {"rms_relative_error_predicted", json_number(one.rms_predicted)},
                    {"rms_log_frf_error_before", json_number(one.frf_before)},
                    {"rms_log_frf_error_fitted", json_number(one.frf_fitted)},
                    {"rms_log_frf_error_predicted", json_number(one.frf_predicted)},
                    {"pairs", std::move(pairs)}});
  }
  return json;
}

Json monte_carlo_json(const ident::UpdateResult& result, const States& states,
                      const ident::UpdateMonteCarlo& study) {
  Json rows = Json::array(), pairs = Json::array();
  for (Eigen::Index j = 0; j < study.mean.size(); ++j) {
    rows.push_back(spread_json(study.mean, study.std, study.low, study.high, j));
    rows.back()["name"] = result.parameters[static_cast<std::size_t>(j)].name;
  }
  for (std::size_t i = 0; i < result.pairs.size(); ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    const auto& pair = result.pairs[i];
    const auto &fitted = study.fitted, &before = study.before;
    pairs.push_back(
        {{"state", states[static_cast<std::size_t>(pair.state)].name},
         {"measured_hz", pair.measured_hz},
         {"fitted_hz", spread_json(fitted.mean, fitted.std, fitted.low, fitted.high, j)},
         {"before_hz", spread_json(before.mean, before.std, before.low, before.high, j)}});
  }
  return {{"samples", study.samples},
          {"failed", study.failed},
          {"parameters", std::move(rows)},
          {"pairs", std::move(pairs)}};
}

/// A frequency measured; NaN where it is not stated.
double measured_std_hz(const ident::UpdatedPair& pair, const ident::UpdateState& state) {
  const auto index = static_cast<std::size_t>(std::max(0, pair.measured));
  return index < state.measured.size() ? state.measured[index].frequency_hz.std : signal::kNaN;
}

/// "-0.123" for a relative error known to the relative uncertainty of its two frequencies.
std::string error_percent(double relative_error, double first_std_hz, double second_std_hz,
                          double frequency_hz) {
  const auto known = [](double std) { return std::isfinite(std) ? std : 0; };
  const double std = std::hypot(known(first_std_hz), known(second_std_hz)) / frequency_hz;
  return std > 0 ? value_digits(100 * relative_error, 100 * std)
                 : fmt::format("{:.2f}", 100 * relative_error);
}

std::string percent(double ratio) {
  return std::isfinite(ratio) ? fmt::format("{:.2f} %", 100 * ratio) : "-";
}

void print_update(std::ostream& out, const ident::UpdateResult& result, const States& states) {
  if (result.fit.ruled_out())
    out << "the data rule this model out: " << ident::fit_text(result.fit) << '\n';
  const auto end = [](double value, double std) {
    return std::isfinite(value) ? value_digits(value, std) : std::string("open");
  };
  out << fmt::format("{:<34} {:>12} {:>12} {:>10}   {}\n", "parameter", "start", "value", "std",
                     "95 % interval");
  for (const auto& p : result.parameters) {
    const double std = p.identifiable ? p.std : 0;
    out << fmt::format("{:<34} {:>12.5g} {:>12} {:>10}   {} .. {}{}\n", p.name, p.start,
                       value_digits(p.value, std), p.identifiable ? std_digits(std) : "not known",
                       end(p.low, std), end(p.high, std),
                       p.interval_by_profile ? " (profile)" : "");
  }
  print_budget(out, result);
  out << fmt::format("{:<24} {:>12} {:>12} {:>9} {:>9}  {}\n", "state", "measured, Hz", "model, Hz",
                     "std", "error", "mode");
  for (const auto& pair : result.pairs) {
    const auto& state = states[static_cast<std::size_t>(pair.state)];
    const double std = measured_std_hz(pair, state);
    out << fmt::format("{:<24} {:>12} {:>12} {:>9} {:>7} %  {} {}{}\n", state.name,
                       value_digits(pair.measured_hz, std),
                       value_digits(pair.model_hz, pair.model_std_hz),
                       std_digits(pair.model_std_hz),
                       error_percent(pair.relative_error, std, pair.model_std_hz, pair.measured_hz),
                       model::name_of(pair.plane), pair.order + 1,
                       pair.cross_plane ? " (leakage, not fitted)" : "");
  }
  for (const auto& lone : result.unpaired) {
    const auto& name = states[static_cast<std::size_t>(lone.state)].name;
    const std::string hz = fmt::format("{:.4f}", lone.frequency_hz);
    out << fmt::format("{:<24} {:>12} {:>12} {:>9} {:>9}  {}\n", name, lone.measured ? hz : "-",
                       lone.measured ? "-" : hz, "", "unpaired", lone.reason);
  }
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
