// Result of an update: parameters with their uncertainty and its sources, pairs, the misfit, and
// all answers that the data support.
#pragma once

#include "ident/statistics/uncertainty.h"
#include "ident/update/pairing/mode_assignment.h"
#include "model/linear/modal_analysis.h"

namespace rigfit::ident {

/// A value and its std of members that hold them apart.
template <class Value, class Std>
constexpr auto estimate_of(Value value, Std std) {
  return [=](const auto& x) { return Estimate{x.*value, x.*std}; };
}

enum class UpdateStatus { converged, not_converged, no_model, too_little_data };
[[nodiscard]] const char* name_of(UpdateStatus status);

/// Contribution of one source to a parameter's uncertainty; the squares of all add up to std^2.
struct UpdateBudgetTerm {
  std::string source;  ///< "data", "prior of ...", or an input's name
  double std = 0;
  /// For an input: change of the value when the input is larger by one standard
  /// uncertainty; NaN for other sources and those of several parts.
  double change = kNaN;

  static constexpr auto fields() {
    using T = UpdateBudgetTerm;
    return std::tuple{field("source", &T::source, "", "source", "data, a prior or an input"),
                      field("std", &T::std, "", "contribution", "the squares add up", 2),
                      field("change", &T::change, "", "",
                            "of the value, by one standard uncertainty of an input")};
  }
};

struct UpdatedParameter {
  std::string name;
  int state = -1;  ///< -1: shared
  double start = 0, value = 0;
  double std = 0;  ///< NaN when not identifiable
  /// 95 % interval; of all alternatives together where there are several; NaN: open on this side.
  double low = kNaN;
  double high = kNaN;
  bool interval_by_profile = false;  ///< else linear, in ln(value) where the value is positive
  bool identifiable = false;
  double std_from_data = 0;  ///< without priors; NaN if the data do not determine it
  bool at_bound = false;
  double segment_shift = 0;  ///< what the scene's segments move the value by; 0: not known
  std::vector<UpdateBudgetTerm> budget = {};  ///< empty when not identifiable

  /// Shares of its variance by source.
  [[nodiscard]] describe::ByName variance_shares() const {
    describe::ByName shares;
    for (const auto& term : budget) {
      shares.all.emplace_back(term.source, std::pow(term.std / std, 2));
    }
    return shares;
  }

  static constexpr auto fields() {
    using namespace describe;
    using T = UpdatedParameter;
    return std::tuple{
        field("name", &T::name, "", "parameter", "of the scene"),
        field("start", &T::start, "", "start", "as the scene says", 5),
        field("", estimate_of(&T::value, &T::std), "", "value", ""),
        field("value", &T::value, "", "", "fitted"),
        field("std", &T::std, "", "", "null where it is not identifiable"),
        field("low", &T::low, "", "", "95 %; null: open"),
        field("high", &T::high, "", "", "95 %; null: open"),
        field(
            "",
            [](const T& p) {
              return OpenEnds{p.low, p.high, p.std};
            },
            "", "95 % interval", ""),
        field(
            "interval", [](const T& p) { return p.interval_by_profile ? "profile" : "linear"; }, "",
            "", "how the ends were found"),
        field(
            "",
            [](const T& p) {
              return !p.identifiable ? "not known" : p.interval_by_profile ? "profile" : "";
            },
            "", "remark", ""),
        field("identifiable", &T::identifiable, "", "", "the data and priors determine it"),
        field("std_from_data", &T::std_from_data, "", "", "without priors"),
        field("at_bound", &T::at_bound, "", "", "of its range"),
        field("budget", &T::budget, "", "", "where the uncertainty comes from")};
  }
};

/// A measured mode and the modelled one it is fitted to.
struct UpdateMatch {
  int state = 0, measured = 0;
  model::ModePlane plane = model::ModePlane::in;
  int order = 0;  ///< among the modelled modes of that plane, from 0
  double mac = 0;
  bool cross_plane = false;  ///< listed, not fitted
  bool operator==(const UpdateMatch& other) const {
    return state == other.state && measured == other.measured && plane == other.plane &&
           order == other.order && cross_plane == other.cross_plane;
  }
};

/// A measured mode with its partner in the model, or one of either that has none.
struct UpdatedPair : UpdateMatch {
  std::string state_name = {};
  double measured_hz = kNaN, model_hz = kNaN;  ///< NaN: there is none
  double relative_error = kNaN;
  double measured_damping = kNaN, model_damping = kNaN;  ///< NaN: not measured
  double measured_std_hz = kNaN;
  double model_std_hz = kNaN;  ///< from parameters and inputs; NaN: unknown
  std::string reason = {};     ///< why it has no partner

  [[nodiscard]] bool is_pair() const { return measured_hz > 0 && model_hz > 0; }
  /// A modelled mode that the test should have seen.
  [[nodiscard]] bool missing() const { return !(measured_hz > 0); }

  static constexpr auto fields() {
    using namespace describe;
    using T = UpdatedPair;
    // A member of a pair; nothing without one.
    constexpr auto of_pair = [](auto get) { return where(&T::is_pair, get); };
    constexpr auto error = [](const T& p) -> Estimate {
      const auto known = [](double std) { return std::isfinite(std) ? std : 0; };
      return {p.relative_error,
              std::hypot(known(p.measured_std_hz), known(p.model_std_hz)) / p.measured_hz};
    };
    return std::tuple{
        field("state", &T::state_name, "", "state", "of the rig"),
        field("measured_hz", &T::measured_hz, "", "", "null: no partner"),
        field("model_hz", &T::model_hz, "", "", "null: no partner"),
        field("", estimate_of(&T::measured_hz, &T::measured_std_hz), "Hz", "measured", ""),
        field("", estimate_of(&T::model_hz, &T::model_std_hz), "Hz", "model", ""),
        field("relative_error", of_pair(&T::relative_error), "", "", "model over measured, less 1"),
        field("", error, "%", "error", ""),
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
            [](const T& p) {
              return p.cross_plane ? std::string("leakage, not fitted") : p.reason;
            },
            "", "remark", "why it has no partner")};
  }
};

/// Agreement of the fit with the stated uncertainties of its data. If the probability of the misfit
/// is below 5 %, the excess is attributed to a random error of the model: a relative error in
/// frequency, independent for every state and mode, by Paule and Mandel's estimate; or shared by
/// the states of a mode and by the modes of a state if that gives larger uncertainties.
struct UpdateFit {
  double chi2 = 0, degrees_of_freedom = 0;
  double p_value = kNaN;  ///< NaN: no degree of freedom
  bool stated = false;    ///< the uncertainties came with the data; else they are assumed
  double model_std = 0;   ///< std of that random error, relative in frequency
  /// Std of such a random error of FRFs, relative in every line, beyond the lines' uncertainties
  /// and shared errors (inputs, place of the hits).
  double frf_model_std = 0;
  double rms_error = 0, worst_error = 0;  ///< relative, of the pairs; 0 in fits of FRFs
  /// Whether the model is another structure's, whatever the data's uncertainties: 3 % is the
  /// largest error that is summed over, and a sound model reaches it in few modes only.
  [[nodiscard]] bool far_off() const { return rms_error > 0.02 || worst_error > 0.05; }
  [[nodiscard]] bool ruled_out() const { return stated ? p_value < 0.01 : far_off(); }
  /// "chi-square 12.3 on 8 degrees of freedom, probability 0.14 ...".
  [[nodiscard]] std::string text() const;

  static constexpr auto fields() {
    using T = UpdateFit;
    return std::tuple{
        field("chi2", &T::chi2, "", "chi-square", "misfit"),
        field("degrees_of_freedom", &T::degrees_of_freedom, "", "degrees of freedom", ""),
        field("p_value", &T::p_value, "", "probability", "of such a misfit"),
        field(
            "uncertainties", [](const T& f) { return f.stated ? "stated" : "assumed"; }, "", "",
            "stated or assumed"),
        field("model_std", &T::model_std, "", "",
              "random error of the model, relative in frequency"),
        field("frf_model_std", &T::frf_model_std, "", "", "the same of FRFs")};
  }
};

/// Values of an answer.
struct FittedValues {
  std::vector<UpdatedParameter> parameters;
  std::vector<UpdatedPair> pairs;
  std::vector<UpdatedPair> unpaired;
  double rms_relative_error = 0;  ///< NaN without pairs

  /// The pairs, then what has no partner.
  [[nodiscard]] std::vector<UpdatedPair> rows() const {
    auto all = pairs;
    all.insert(all.end(), unpaired.begin(), unpaired.end());
    return all;
  }
};

/// One of the answers that the data support, with the likelihood of its assignment.
struct UpdateAlternative : AssignmentLikelihood, FittedValues {
  double weight = 1;  ///< probability, all alternatives together 1
  double log_evidence = 0;
  double model_std = 0;  ///< as in UpdateFit

  static constexpr auto fields() {
    using T = UpdateAlternative;
    return std::tuple{field("weight", &T::weight),
                      field("log_evidence", &T::log_evidence),
                      field("log_detected", &T::log_detected),
                      field("log_false", &T::log_false),
                      field("log_missed", &T::log_missed),
                      field("model_std", &T::model_std),
                      field("parameters", &T::parameters),
                      field("pairs", &T::rows),
                      field("rms_relative_error", &T::rms_relative_error)};
  }
};

/// A state predicted from the fit of the others.
struct HeldOut {
  int state = 0;
  std::string name;  ///< the state's
  UpdateStatus status = UpdateStatus::not_converged;
  double rms_fitted = kNaN;     ///< over the fitted states
  double rms_predicted = kNaN;  ///< held-out state
  double rms_before = kNaN;     ///< held-out state, at the start values
  double frf_fitted = kNaN, frf_predicted = kNaN,
         frf_before = kNaN;                          ///< rms |ln FRF ratio| likewise
  std::vector<UpdatedPair> pairs;                    ///< held-out state
  std::optional<model::Scene> scene = std::nullopt;  ///< held-out state, as predicted

  static constexpr auto fields() {
    using T = HeldOut;
    return std::tuple{
        field("state", &T::name, "", "held out", ""),
        field("status", &T::status),
        field("rms_relative_error_before", &T::rms_before, "%", "before", "", 3),
        field("rms_relative_error_fitted", &T::rms_fitted, "%", "others fitted", "", 3),
        field("rms_relative_error_predicted", &T::rms_predicted, "%", "predicted", "", 3),
        field("rms_log_frf_error_before", &T::frf_before),
        field("rms_log_frf_error_fitted", &T::frf_fitted),
        field("rms_log_frf_error_predicted", &T::frf_predicted),
        field("pairs", &T::pairs)};
  }
};

struct UpdateResult : FittedValues {
  UpdateStatus status = UpdateStatus::not_converged;
  std::string message;  ///< for a person, when not converged or doubtful
  /// By data and priors, in the fitted coordinates (relative): the parameters, then what is known
  /// to an uncertainty.
  Identifiability identifiability;
  MatrixXd covariance;                    ///< parameters' values, all sources; NaN where not
                                          ///< identifiable
  MatrixXd correlation;                   ///< NaN like the covariance
  std::vector<std::string> open;          ///< what the data cannot separate, in words
  std::vector<UpdatedPair> pairs_before;  ///< at the start values
  double rms_relative_error_before = 0;   ///< likewise; NaN without pairs
  double rms_held_out = kNaN;             ///< over all pairs that were held out; NaN without
  /// Rms of |ln(H_model / H_measured)| over the lines that are fitted; NaN without FRFs.
  double rms_log_frf_error = kNaN;
  double rms_log_frf_error_before = kNaN;
  Index frf_lines = 0;
  UpdateFit fit;
  /// Answers of weight 0.001 or more, heaviest first; the first is this result. For fits to modes.
  std::vector<UpdateAlternative> alternatives;
  double log_evidence = kNaN;  ///< ln, over all answers
  double variance_factor = 1;
  double coverage_factor = 1.96;     ///< for 95 %
  int starts = 0;                    ///< local fits of the search
  std::vector<model::Scene> scenes;  ///< updated, by state
  std::vector<HeldOut> held = {};    ///< each state, if asked for
  VectorXd coordinates;              ///< solution, as identifiability has them, for refits

  static constexpr auto fields() {
    using namespace describe;
    using T = UpdateResult;
    constexpr auto of_frfs = [](auto get) {
      return where([](const T& r) { return r.frf_lines > 0; }, get);
    };
    return std::tuple{
        field("status", &T::status),
        field("parameters", &T::parameters, "", "parameters", ""),
        field("", within(&T::fit, &UpdateFit::text), "", "fit", ""),
        field("fit", &T::fit),
        field("alternatives", &T::alternatives),
        field("log_evidence", &T::log_evidence),
        field("correlation", &T::correlation),
        field("not_identifiable", &T::open),
        field("pairs", &T::rows, "", "pairs", ""),
        field("rms_relative_error", &T::rms_relative_error, "%", "rms of the paired errors", "", 3),
        field("rms_relative_error_before", &T::rms_relative_error_before, "%", "before the fit", "",
              3),
        field("hold_out", &T::held, "", "held out", "each state, predicted from the others"),
        field("rms_relative_error_held_out", &T::rms_held_out),
        field("starts", &T::starts),
        field("frf_lines", &T::frf_lines),
        field("rms_log_frf_error", of_frfs(&T::rms_log_frf_error), "",
              "rms of |ln(model / measured)| of FRF lines", "", 3),
        field("rms_log_frf_error_before", of_frfs(&T::rms_log_frf_error_before), "",
              "before the fit", "", 3)};
  }
};

}  // namespace rigfit::ident
