#include "apps/cli/update_result.h"

#include <fmt/format.h>

#include <cmath>

#include "apps/cli/json_document.h"

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

Json pair_json(const ident::UpdatedPair& pair, const UpdateStates& states) {
  Json json{{"state", states.states[static_cast<std::size_t>(pair.state)].name},
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

Json pairs_json(const ident::UpdateResult& result, const UpdateStates& states) {
  Json pairs = Json::array();
  for (const auto& pair : result.pairs) pairs.push_back(pair_json(pair, states));
  for (const auto& lone : result.unpaired) {
    pairs.push_back({{"state", states.states[static_cast<std::size_t>(lone.state)].name},
                     {"measured_hz", lone.measured ? Json(lone.frequency_hz) : Json(nullptr)},
                     {"model_hz", lone.measured ? Json(nullptr) : Json(lone.frequency_hz)},
                     {"relative_error", nullptr},
                     {"reason", lone.reason}});
  }
  return pairs;
}

Json monte_carlo_json(const ident::UpdateResult& result, const UpdateStates& states,
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
        {{"state", states.states[static_cast<std::size_t>(pair.state)].name},
         {"measured_hz", pair.measured_hz},
         {"fitted_hz", spread_json(fitted.mean, fitted.std, fitted.low, fitted.high, j)},
         {"before_hz", spread_json(before.mean, before.std, before.low, before.high, j)}});
  }
  return {{"samples", study.samples},
          {"failed", study.failed},
          {"parameters", std::move(rows)},
          {"pairs", std::move(pairs)}};
}

std::string percent(double ratio) {
  return std::isfinite(ratio) ? fmt::format("{:.2f} %", 100 * ratio) : "-";
}

void print_update(std::ostream& out, const ident::UpdateResult& result,
                  const UpdateStates& states) {
  out << fmt::format("{:<34} {:>12} {:>12} {:>10}\n", "parameter", "start", "value", "std");
  for (const auto& p : result.parameters) {
    out << fmt::format("{:<34} {:>12.5g} {:>12.5g} {:>10}\n", p.name, p.start, p.value,
                       p.identifiable ? fmt::format("{:.2g}", p.std) : "not known");
  }
  print_budget(out, result);
  out << fmt::format("{:<24} {:>12} {:>12} {:>9} {:>9}  {}\n", "state", "measured, Hz", "model, Hz",
                     "std", "error", "mode");
  for (const auto& pair : result.pairs) {
    out << fmt::format(
        "{:<24} {:>12.4f} {:>12.4f} {:>9} {:>7.2f} %  {} {}{}\n",
        states.states[static_cast<std::size_t>(pair.state)].name, pair.measured_hz, pair.model_hz,
        std::isfinite(pair.model_std_hz) ? fmt::format("{:.2g}", pair.model_std_hz) : "-",
        100 * pair.relative_error, model::name_of(pair.plane), pair.order + 1,
        pair.cross_plane ? " (leakage, not fitted)" : "");
  }
  for (const auto& lone : result.unpaired) {
    const auto& name = states.states[static_cast<std::size_t>(lone.state)].name;
    const std::string hz = fmt::format("{:.4f}", lone.frequency_hz);
    out << fmt::format("{:<24} {:>12} {:>12} {:>9} {:>9}  {}\n", name, lone.measured ? hz : "-",
                       lone.measured ? "-" : hz, "", "unpaired", lone.reason);
  }
  if (!result.pairs.empty()) {
    out << fmt::format("rms of the paired errors: {} before, {} fitted\n",
                       percent(result.rms_relative_error_before),
                       percent(result.rms_relative_error));
  }
  if (result.frf_lines > 0) {
    out << fmt::format(
        "rms of |ln(model / measured)| over {} FRF lines: {:.3f} before, {:.3f} fitted\n",
        result.frf_lines, result.rms_log_frf_error_before, result.rms_log_frf_error);
  }
  if (std::isfinite(result.history_error)) {
    out << fmt::format("rms of model less record over the record's: {:.2g} before, {:.2g} fitted\n",
                       result.history_error_before, result.history_error);
  }
}

}  // namespace rigfit::apps
