// What an update found, as it is printed and written: described.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "document/describe.h"
#include "ident/update/model_candidates.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {

/// The pairs, then what has no partner.
[[nodiscard]] inline std::vector<UpdatedPair> pair_rows(std::vector<UpdatedPair> pairs,
                                                        const std::vector<UpdatedPair>& unpaired) {
  pairs.insert(pairs.end(), unpaired.begin(), unpaired.end());
  return pairs;
}

/// Shares of a parameter's variance by source.
[[nodiscard]] inline describe::ByName variance_shares(const UpdatedParameter& parameter) {
  describe::ByName shares;
  for (const auto& term : parameter.budget) {
    shares.all.emplace_back(term.source, std::pow(term.std / parameter.std, 2));
  }
  return shares;
}

}  // namespace rigfit::ident

namespace rigfit::describe {

template <>
struct Described<ident::UpdateBudgetTerm> {
  using T = ident::UpdateBudgetTerm;
  static constexpr std::string_view title{};
  static constexpr auto fields = std::tuple{
      field("source", &T::source, "", "source", "data, a prior or an input"),
      field("std", &T::std, "", "contribution", "the squares add up", 2),
      field("change", &T::change, "", "", "of the value, by one standard uncertainty of an input")};
};

template <>
struct Described<ident::UpdatedParameter> {
  using T = ident::UpdatedParameter;
  static constexpr std::string_view title{};
  static constexpr auto fields = std::tuple{
      field("name", &T::name, "", "parameter", "of the scene"),
      field("start", &T::start, "", "start", "as the scene says", 5),
      field(
          "",
          [](const T& p) {
            return signal::Estimate{p.value, p.identifiable ? p.std : 0};
          },
          "", "value", ""),
      field("value", &T::value, "", "", "fitted"),
      field("std", &T::std, "", "", "null where it is not identifiable"),
      field("low", &T::low, "", "", "95 %; null: open"),
      field("high", &T::high, "", "", "95 %; null: open"),
      field(
          "",
          [](const T& p) {
            return OpenEnds{p.low, p.high, p.identifiable ? p.std : 0};
          },
          "", "95 % interval", ""),
      field(
          "interval", [](const T& p) { return p.interval_by_profile ? "profile" : "linear"; }, "",
          "", "how the ends were found"),
      field(
          "",
          [](const T& p) {
            return std::string(!p.identifiable         ? "not known"
                               : p.interval_by_profile ? "profile"
                                                       : "");
          },
          "", "remark", ""),
      field("identifiable", &T::identifiable, "", "", "the data and priors determine it"),
      field("std_from_data", &T::std_from_data, "", "", "without priors"),
      field("at_bound", &T::at_bound, "", "", "of its range"),
      field("budget", &T::budget, "", "", "where the uncertainty comes from")};
};

template <>
struct Described<ident::UpdateFit> {
  using T = ident::UpdateFit;
  static constexpr auto fields = std::tuple{
      field("chi2", &T::chi2, "", "chi-square", "misfit"),
      field("degrees_of_freedom", &T::degrees_of_freedom, "", "degrees of freedom", ""),
      field("p_value", &T::p_value, "", "probability", "of such a misfit"),
      field(
          "uncertainties", [](const T& f) { return f.stated ? "stated" : "assumed"; }, "", "",
          "stated or assumed"),
      field("model_std", &T::model_std, "", "", "random error of the model, relative in frequency"),
      field("frf_model_std", &T::frf_model_std, "", "", "the same of FRFs")};
};

template <>
struct Described<ident::UpdatedPair> {
  using T = ident::UpdatedPair;
  static constexpr std::string_view title{};
  /// A member of a pair; nothing without one.
  static constexpr auto of_pair = [](auto get) { return where(&T::is_pair, get); };
  static signal::Estimate error(const T& p) {
    const auto known = [](double std) { return std::isfinite(std) ? std : 0; };
    return {p.relative_error,
            std::hypot(known(p.measured_std_hz), known(p.model_std_hz)) / p.measured_hz};
  }
  static constexpr auto fields = std::tuple{
      field("state", &T::state_name, "", "state", "of the rig"),
      field("measured_hz", &T::measured_hz, "", "", "null: no partner"),
      field("model_hz", &T::model_hz, "", "", "null: no partner"),
      field(
          "",
          [](const T& p) {
            return signal::Estimate{p.measured_hz, p.measured_std_hz};
          },
          "Hz", "measured", ""),
      field(
          "",
          [](const T& p) {
            return signal::Estimate{p.model_hz, p.model_std_hz};
          },
          "Hz", "model", ""),
      field("relative_error", of_pair(&T::relative_error), "", "", "model over measured, less 1"),
      field("", &error, "%", "error", ""),
      field("plane", of_pair(&T::plane), "", "plane", "in, out ..."),
      field("order", of_pair([](const T& p) { return p.order + 1; }), "", "order",
            "among the modes of its plane"),
      field("mac", of_pair(&T::mac), "", "MAC", "of the shapes", 3),
      field("measured_damping_ratio", of_pair(&T::measured_damping), "", "", ""),
      field("model_damping_ratio", of_pair(&T::model_damping), "", "", ""),
      field("model_std_hz", of_pair(&T::model_std_hz), "Hz", "", ""),
      field("leakage", &T::cross_plane, "", "", "not fitted"),
      field(
          "reason",
          [](const T& p) { return p.cross_plane ? std::string("leakage, not fitted") : p.reason; },
          "", "remark", "why it has no partner")};
};

template <>
struct Described<ident::UpdateAlternative> {
  using T = ident::UpdateAlternative;
  static constexpr auto fields =
      std::tuple{field("weight", &T::weight),
                 field("log_evidence", &T::log_evidence),
                 field("log_detected", &T::log_detected),
                 field("log_false", &T::log_false),
                 field("log_missed", &T::log_missed),
                 field("model_std", &T::model_std),
                 field("parameters", &T::parameters),
                 field("pairs", [](const T& a) { return ident::pair_rows(a.pairs, a.unpaired); }),
                 field("rms_relative_error", &T::rms_relative_error)};
};

template <>
struct Described<ident::UpdateResult> {
  using T = ident::UpdateResult;
  static constexpr auto fields =
      std::tuple{field("status", &T::status),
                 field("parameters", &T::parameters),
                 field("fit", &T::fit),
                 field("alternatives", &T::alternatives),
                 field("log_evidence", &T::log_evidence),
                 field("correlation", &T::correlation),
                 field("not_identifiable", &T::open),
                 field("pairs", [](const T& r) { return ident::pair_rows(r.pairs, r.unpaired); }),
                 field("rms_relative_error", &T::rms_relative_error),
                 field("rms_relative_error_before", &T::rms_relative_error_before),
                 field("starts", &T::starts),
                 field("frf_lines", &T::frf_lines),
                 field("rms_log_frf_error", &T::rms_log_frf_error),
                 field("rms_log_frf_error_before", &T::rms_log_frf_error_before)};
};

template <>
struct Described<ident::HeldOut> {
  using T = ident::HeldOut;
  static constexpr std::string_view title{};
  static constexpr auto fields =
      std::tuple{field("state", &T::name, "", "held out", ""),
                 field("status", &T::status),
                 field("rms_relative_error_before", &T::rms_before, "%", "before", "", 3),
                 field("rms_relative_error_fitted", &T::rms_fitted, "%", "others fitted", "", 3),
                 field("rms_relative_error_predicted", &T::rms_predicted, "%", "predicted", "", 3),
                 field("rms_log_frf_error_before", &T::frf_before),
                 field("rms_log_frf_error_fitted", &T::frf_fitted),
                 field("rms_log_frf_error_predicted", &T::frf_predicted),
                 field("pairs", &T::pairs)};
};

/// A member of the fit; nothing without one.
template <class Get>
constexpr auto of_fit(Get get) {
  return where(
      [](const ident::FittedCandidate& c) {
        return c.result.status != ident::UpdateStatus::no_model;
      },
      within(&ident::FittedCandidate::result, get));
}

template <>
struct Described<ident::FittedCandidate> {
  using T = ident::FittedCandidate;
  using Result = ident::UpdateResult;
  static constexpr std::string_view title{};
  static constexpr auto fields = std::tuple{
      field("name", &T::name, "", "candidate", ""),
      field("weight", &T::weight, "", "weight", "of all candidates", 3),
      field("log_evidence", of_fit(&Result::log_evidence), "", "ln evidence", "", 5),
      field("chi2", of_fit(within(&Result::fit, &ident::UpdateFit::chi2)), "", "chi-square", "", 4),
      field("degrees_of_freedom",
            of_fit(within(&Result::fit, &ident::UpdateFit::degrees_of_freedom)), "",
            "degrees of freedom", "", 4),
      field("p_value", of_fit(within(&Result::fit, &ident::UpdateFit::p_value)), "", "probability",
            "of such a misfit", 3),
      field("status", within(&T::result, &Result::status)),
      field("message", within(&T::result, &Result::message), "", "remark", ""),
      field("parameters", within(&T::result, &Result::parameters))};
};

}  // namespace rigfit::describe
