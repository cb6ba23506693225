// Result of an update: parameters with their uncertainty and its sources, pairs, the misfit, and
// all answers that the data support.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "ident/statistics/uncertainty.h"
#include "ident/update/pairing/mode_assignment.h"
#include "model/linear/modal_analysis.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {

enum class UpdateStatus { converged, not_converged, no_model, too_little_data };
[[nodiscard]] const char* name_of(UpdateStatus status);

/// Contribution of one source to a parameter's uncertainty; the squares of all add up to std^2.
struct UpdateBudgetTerm {
  std::string source;  ///< "data", "prior of ...", or an input's name
  double std = 0;
  /// For an input: change of the value when the input is larger by one standard
  /// uncertainty; NaN for other sources and those of several parts.
  double change = std::numeric_limits<double>::quiet_NaN();
};

struct UpdatedParameter {
  std::string name;
  int state = -1;  ///< -1: shared
  double start = 0, value = 0;
  double std = 0;  ///< NaN when not identifiable
  /// 95 % interval; of all alternatives together where there are several; NaN: open on this side.
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
  bool interval_by_profile = false;  ///< else linear, in ln(value) where the value is positive
  bool identifiable = false;
  double std_from_data = 0;  ///< without priors; NaN if the data do not determine it
  bool at_bound = false;
  double segment_shift = 0;  ///< of the value by the segments that the scene gives; 0: not known
  std::vector<UpdateBudgetTerm> budget = {};  ///< empty when not identifiable
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
  double measured_hz = signal::kNaN, model_hz = signal::kNaN;  ///< NaN: there is none
  double relative_error = signal::kNaN;
  double measured_damping = signal::kNaN, model_damping = signal::kNaN;  ///< NaN: not measured
  double measured_std_hz = signal::kNaN;
  double model_std_hz = signal::kNaN;  ///< from parameters and inputs; NaN: unknown
  std::string reason = {};             ///< why it has no partner

  [[nodiscard]] bool is_pair() const { return measured_hz > 0 && model_hz > 0; }
  /// A modelled mode that the test should have seen.
  [[nodiscard]] bool missing() const { return !(measured_hz > 0); }
};

/// Agreement of the fit with the stated uncertainties of its data. If the probability of the misfit
/// is below 5 %, the excess is attributed to a random error of the model: a relative error in
/// frequency, independent for every state and mode, by Paule and Mandel's estimate; or shared by
/// the states of a mode and by the modes of a state if that gives larger uncertainties.
struct UpdateFit {
  double chi2 = 0, degrees_of_freedom = 0;
  double p_value = std::numeric_limits<double>::quiet_NaN();  ///< NaN: no degree of freedom
  bool stated = false;   ///< the uncertainties came with the data; else they are assumed
  double model_std = 0;  ///< std of that random error, relative in frequency
  /// Std of such a random error of FRFs, relative in every line, beyond the lines' uncertainties
  /// and shared errors (inputs, place of the hits).
  double frf_model_std = 0;
  double rms_error = 0, worst_error = 0;  ///< relative, of the pairs; 0 in fits of FRFs
  /// Whether the model is another structure's, whatever the data's uncertainties: 3 % is the
  /// largest error that is summed over, and a sound model reaches it in few modes only.
  [[nodiscard]] bool far_off() const { return rms_error > 0.02 || worst_error > 0.05; }
  [[nodiscard]] bool ruled_out() const { return stated ? p_value < 0.01 : far_off(); }
};

/// Values of an answer.
struct FittedValues {
  std::vector<UpdatedParameter> parameters;
  std::vector<UpdatedPair> pairs;
  std::vector<UpdatedPair> unpaired;
  double rms_relative_error = 0;  ///< NaN without pairs
};

/// One of the answers that the data support, with the likelihood of its assignment.
struct UpdateAlternative : AssignmentLikelihood, FittedValues {
  double weight = 1;  ///< probability, all alternatives together 1
  double log_evidence = 0;
  double model_std = 0;  ///< as in UpdateFit
};

/// A state predicted from the fit of the others.
struct HeldOut {
  int state = 0;
  std::string name;  ///< the state's
  UpdateStatus status = UpdateStatus::not_converged;
  double rms_fitted = signal::kNaN;     ///< over the fitted states
  double rms_predicted = signal::kNaN;  ///< held-out state
  double rms_before = signal::kNaN;     ///< held-out state, at the start values
  double frf_fitted = signal::kNaN, frf_predicted = signal::kNaN,
         frf_before = signal::kNaN;                  ///< rms |ln FRF ratio| likewise
  std::vector<UpdatedPair> pairs;                    ///< held-out state
  std::optional<model::Scene> scene = std::nullopt;  ///< held-out state, as predicted
};

struct UpdateResult : FittedValues {
  UpdateStatus status = UpdateStatus::not_converged;
  std::string message;  ///< for a person, when not converged or doubtful
  /// By data and priors, in the fitted coordinates (relative): the parameters, then what is known
  /// to an uncertainty.
  Identifiability identifiability;
  Eigen::MatrixXd covariance;             ///< parameters' values, all sources; NaN where not
                                          ///< identifiable
  Eigen::MatrixXd correlation;            ///< NaN like the covariance
  std::vector<std::string> open;          ///< what the data cannot separate, in words
  std::vector<UpdatedPair> pairs_before;  ///< at the start values
  double rms_relative_error_before = 0;   ///< likewise; NaN without pairs
  double rms_held_out = signal::kNaN;     ///< over all pairs that were held out; NaN without
  /// Rms of |ln(H_model / H_measured)| over the lines that are fitted; NaN without FRFs.
  double rms_log_frf_error = std::numeric_limits<double>::quiet_NaN();
  double rms_log_frf_error_before = std::numeric_limits<double>::quiet_NaN();
  Eigen::Index frf_lines = 0;
  UpdateFit fit;
  /// Answers of weight 0.001 or more, heaviest first; the first is this result. For fits to modes.
  std::vector<UpdateAlternative> alternatives;
  double log_evidence = std::numeric_limits<double>::quiet_NaN();  ///< ln, over all answers
  double chi_squared = 0, degrees_of_freedom = 0;  ///< with the final weights of the fit
  double variance_factor = 1;
  double coverage_factor = 1.96;     ///< for 95 %
  int starts = 0;                    ///< local fits of the search
  std::vector<model::Scene> scenes;  ///< updated, by state
  std::vector<HeldOut> held = {};    ///< each state, if asked for
  Eigen::VectorXd coordinates;       ///< solution, as identifiability has them, for refits
};

}  // namespace rigfit::ident
