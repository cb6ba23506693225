// Fitting a scene's uncertain parameters to measured modes.
//
// Unknowns p (stiffnesses, masses, tensions, spans ... of one scene in one or several states, such
// as several tensions) minimise
//
//   sum_pairs rho((ln f_model(p) - ln f_measured) / s) + the same of damping ratios where measured
//   + the same of shapes where asked for (both of unit length, the model's sign)
//   + sum_samples rho((y_model(p) - y_measured) / s) of time histories where measured
//   + sum_lines rho(Re, Im of ln(H_model(p) / H_measured) / s) of FRFs where measured
//   + sum_priors ((p - p0) / s_p)^2
//
// with Huber's rho, s the relative standard uncertainty of the measured value and of the model
// together. Positive parameters are fitted in their logarithm. Derivatives are the model's own
// sensitivities (equilibrium's change included), the minimiser is Ceres' Levenberg-Marquardt; modes
// are paired anew (mode_pairing.h) until the pairs stay, from several starts. A modelled mode is
// followed by its plane and its place among the modes of that plane, which crossings of planes do
// not change.
//
// Uncertainty, to first order: the data's scatter and the priors through (J'J)^-1; what is known of
// the scene but not fitted (`UncertainInput`) and the error of the segments through the shift
// -(J'J)^-1 J' (d residuals) that it causes. The error of segments that a
// scene leaves to the program is taken off the frequencies, what may be left of it counts
// (update_segments.h); that of all others is 4/3 of their difference
// to a model of twice as many segments (Richardson, second order; a fourth-order error comes out a
// quarter too large). Shifts of one source are shared by all parameters and all predictions, so
// that what the fit makes up for is not counted against what it predicts.
// Sources: Friswell and Mottershead 1995; Mottershead, Link, Friswell 2011.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "ident/statistics/uncertainty.h"
#include "ident/update/mode_pairing.h"
#include "model/linear/frf_sensitivities.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/force_history.h"
#include "signal/numerics/estimate.h"

namespace rigfit::ident {

struct FreeParameter {
  std::string name;  ///< for people and results
  /// Scene parameters (see model::parameter) that all take this value; empty: `name` itself.
  std::vector<std::string> targets = {};
  /// What each target is of the value, such as -1 for the other end of a symmetric rig; empty: 1.
  std::vector<double> factors = {};
  bool per_state = false;                                 ///< a value of its own in every state
  std::optional<double> start = std::nullopt;             ///< else as the scene has it
  std::optional<signal::Estimate> prior = std::nullopt;   ///< from a test before
  double low = -std::numeric_limits<double>::infinity();  ///< bounds; positive ones stay so anyway
  double high = std::numeric_limits<double>::infinity();

  [[nodiscard]] double factor(std::size_t target) const {
    return target < factors.size() ? factors[target] : 1;
  }
};

/// A number that the fit takes as known: a load cell's reading, a length, a mass, an EI from a
/// bending test. It moves numbers of the scenes, one standard uncertainty of it by `change`.
struct UncertainInput {
  struct Effect {
    int state = 0;
    std::string target;  ///< scene parameter; one that is fitted is not moved
    double change = 0;   ///< by one standard uncertainty
  };
  std::string name;
  std::vector<Effect> effects = {};
};

struct MeasuredMode {
  signal::Estimate frequency_hz;                         ///< std not finite: unknown
  signal::Estimate damping_ratio;                        ///< value not finite: not measured
  std::optional<model::ModePlane> plane = std::nullopt;  ///< of the test
  Eigen::VectorXcd shape = {};  ///< at the scene's sensors, in their order; empty: not measured
};

/// One measured FRF, from a load of the scene to a sensor of it, in the sensor's quantity per N.
struct MeasuredFrf {
  std::size_t sensor = 0, load = 0;  ///< of the scene, in its order
  Eigen::VectorXd frequency_hz;      ///< positive
  Eigen::VectorXcd H;
  Eigen::VectorXd std = {};  ///< of the real and of the imaginary part; empty: unknown
  /// Of an exponential window shared by force and response: the model is taken at
  /// s = i omega + this (model/linear/frf_synthesis.h), so that its own damping is what is fitted.
  double decay_rate_1_s = 0;
  /// Neighbouring lines share their noise under a window: so many of them count as one
  /// (`lines_per_independent` below).
  double lines_per_independent = 1;
};

/// Noise bandwidth of the window exp(-a t) over a block of duration T, in lines of 1/T:
/// (a T / 2) coth(a T / 2). Source: F. J. Harris, Proc. IEEE 66 (1978)
/// 51-83, equivalent noise bandwidth.
[[nodiscard]] double lines_per_independent(double decay_rate_1_s, double line_spacing_hz);

/// What sensors recorded while the scene's own loads acted, from t = 0 of the loads on.
struct MeasuredHistory {
  std::vector<std::size_t> sensors;  ///< of the scene, one a column
  double rate_hz = 0;
  Eigen::MatrixXd samples;   ///< rows (0, 1/rate, ...) x sensors, SI; NaN: not recorded
  Eigen::VectorXd std = {};  ///< of a sample, one a sensor; empty: unknown
  std::vector<model::ForceHistory> records = {};  ///< by load of the scene; for kind `record`
};

/// The rig in one state: its scene as known before, and what was measured.
struct UpdateState {
  std::string name;
  model::Scene scene;
  std::vector<MeasuredMode> measured;
  std::vector<MeasuredFrf> frfs = {};
  std::vector<MeasuredHistory> histories = {};
  /// The modes were found in these FRFs or histories: they lead the fit near and are listed, but do
  /// not count a second time.
  bool modes_lead_only = false;
};

using ModeSolver = std::function<model::ModeSensitivities(
    const model::Scene&, const std::vector<std::string>&, const model::ModesOptions&)>;
using FrfSolver =
    std::function<model::FrfSensitivities(const model::Scene&, const Eigen::VectorXd& frequency_hz,
                                          const std::vector<std::string>&, double decay_rate_1_s)>;

struct UpdateOptions {
  /// Relative standard uncertainty of frequencies that come without one; it then only weighs, the
  /// scatter about the fit gives the variance.
  double assumed_relative_std = 0.01;
  double assumed_damping_relative_std = 0.2;
  /// Relative standard uncertainty of FRFs that come without one; it then only weighs.
  double assumed_frf_relative_std = 0.05;
  /// What the model cannot reach, relative in FRFs, added to every line's uncertainty.
  double frf_model_relative_std = 0;
  /// Lines whose uncertainty is a larger part of the FRF say nothing in their logarithm.
  double frf_max_relative_std = 0.5;
  /// Of time histories that come without one, of their own rms; it then only weighs.
  double assumed_history_relative_std = 0.05;
  /// Standard uncertainty of a component of a unit shape; 0: shapes only pair, they are not fitted.
  double shape_std = 0;
  /// What the model cannot reach, relative in frequency, added to every measured uncertainty.
  double model_relative_std = 0;
  double huber_threshold = 2;  ///< standard deviations beyond which a pair pulls linearly
  PairingOptions pairing = {};
  double first_common_factor = 4;  ///< common_factor_range of the first pairing of each start
  int starts = 4;                  ///< the first is the scene's own values
  double start_spread = 3;         ///< factor by which the others are off, up or down, at most
  std::uint64_t seed = 1;
  int max_iterations = 60;
  double function_tolerance = 1e-9;  ///< relative, of the cost
  int max_pairings = 8;
  int threads = 1;  ///< over the starts
  /// Starts but the first look for their minimum with a third of the segments (from 16 on); only
  /// those that find another one than the first are followed with all.
  bool coarse_starts = true;
  /// The segments' error is taken off frequencies where the scene leaves them to the program, and
  /// what is left of it part of the uncertainties (update_segments.h). False: the data have this
  /// model's segments.
  bool segment_uncertainty = true;
  std::vector<UncertainInput> inputs = {};  ///< independent of each other
  /// Segments of members that leave them to the program, at first: more where the data need them.
  int auto_segments = 30;
  ModeSolver solver = {};     ///< empty: model::analyse_mode_sensitivities
  FrfSolver frf_solver = {};  ///< empty: model::synthesize_frf_sensitivities
};

enum class UpdateStatus { converged, not_converged, no_model, too_little_data };
[[nodiscard]] const char* name_of(UpdateStatus status);

/// What one source adds to a parameter's uncertainty; the squares of all add up to std^2.
struct UpdateBudgetTerm {
  std::string source;  ///< "data", "prior of ...", "segments", or an input's name
  double std = 0;
};

struct UpdatedParameter {
  std::string name;
  int state = -1;  ///< -1: shared
  double start = 0, value = 0;
  double std = 0;  ///< NaN when not identifiable
  bool identifiable = false;
  double std_from_data = 0;  ///< without the priors; NaN when the data alone cannot
  bool at_bound = false;
  std::vector<UpdateBudgetTerm> budget = {};  ///< empty when not identifiable
  /// By how much the value may still be too large for want of segments; NaN: not known.
  double segment_shift = std::numeric_limits<double>::quiet_NaN();
  double segments_taken_off = 0;  ///< by how much it would be larger, had nothing been taken off
};

struct UpdatedPair {
  int state = 0, measured = 0;
  model::ModePlane plane = model::ModePlane::in;
  int order = 0;  ///< among the modelled modes of that plane, from 0
  double measured_hz = 0, model_hz = 0, relative_error = 0, mac = 0;
  double measured_damping = 0, model_damping = 0;  ///< NaN when not measured
  bool cross_plane = false;
  /// Of model_hz, from parameters, inputs and segments together; NaN: not known.
  double model_std_hz = std::numeric_limits<double>::quiet_NaN();
};

struct UpdatedUnpaired {
  int state = 0;
  double frequency_hz = 0;
  bool measured = true;  ///< else modelled
  bool missing = false;
  std::string reason;
};

struct UpdateResult {
  UpdateStatus status = UpdateStatus::not_converged;
  std::string message;  ///< for a person, when not converged or doubtful
  std::vector<UpdatedParameter> parameters;
  Identifiability identifiability;  ///< data and priors, in the fitted coordinates (relative)
  Eigen::MatrixXd covariance;       ///< of the parameters' values, all sources; NaN where not
                                    ///< identifiable
  Eigen::MatrixXd correlation;      ///< the same
  /// Shifts of the fitted coordinates by one standard uncertainty of each shared source.
  Eigen::MatrixXd shifts;
  std::vector<std::string> shift_sources;  ///< "segments" and the inputs; one a column
  std::vector<std::string> open;           ///< what the data cannot separate, in words
  std::vector<UpdatedPair> pairs;
  std::vector<UpdatedUnpaired> unpaired;
  std::vector<UpdatedPair> pairs_before;                         ///< at the start values
  double rms_relative_error = 0, rms_relative_error_before = 0;  ///< NaN without pairs
  /// Rms of |ln(H_model / H_measured)| over the lines that are fitted; NaN without FRFs.
  double rms_log_frf_error = std::numeric_limits<double>::quiet_NaN();
  double rms_log_frf_error_before = std::numeric_limits<double>::quiet_NaN();
  Eigen::Index frf_lines = 0;
  /// Rms of model less measured over that of the measured, all samples; NaN without histories.
  double history_error = std::numeric_limits<double>::quiet_NaN();
  double history_error_before = std::numeric_limits<double>::quiet_NaN();
  double chi_squared = 0, degrees_of_freedom = 0;
  double variance_factor = 1;
  double coverage_factor = 1.96;        ///< for 95 %
  int auto_segments = 0;                ///< as they were in the end, for members that leave them
  int starts = 0, starts_agreeing = 0;  ///< that ended in this answer
  int pairings = 0, model_evaluations = 0;
  std::vector<model::Scene> scenes;  ///< updated, by state
  Eigen::VectorXd coordinates;       ///< of the solution, for refits
};

/// Throws model::SceneError for a parameter that is not there, std::invalid_argument for no state,
/// no parameter, or numbers that make no sense.
[[nodiscard]] UpdateResult update_model(const std::vector<UpdateState>& states,
                                        const std::vector<FreeParameter>& free,
                                        const UpdateOptions& options = {});

/// The modes of the states' scenes as they are, paired with what was measured.
struct PairedModes {
  std::vector<UpdatedPair> pairs;
  std::vector<UpdatedUnpaired> unpaired;
  double rms_relative_error = std::numeric_limits<double>::quiet_NaN();
};
[[nodiscard]] PairedModes compare_with_measured(const std::vector<UpdateState>& states,
                                                const UpdateOptions& options = {});

struct HeldOut {
  int state = 0;
  UpdateStatus status = UpdateStatus::not_converged;
  double rms_fitted = 0;     ///< of the states that were fitted
  double rms_predicted = 0;  ///< of the one held out
  double rms_before = 0;     ///< of the one held out, at the start values
  double frf_fitted = 0, frf_predicted = 0, frf_before = 0;  ///< the same of rms |ln FRF ratio|
  std::vector<UpdatedPair> pairs;                            ///< of the one held out
  std::optional<model::Scene> scene = std::nullopt;          ///< of the one held out, as predicted
};

/// Each state in turn is left out, the others fitted, and it is predicted by what is shared.
[[nodiscard]] std::vector<HeldOut> hold_out_each(const std::vector<UpdateState>& states,
                                                 const std::vector<FreeParameter>& free,
                                                 const UpdateOptions& options = {});

struct UpdateMonteCarlo {
  int samples = 0, failed = 0;
  Eigen::MatrixXd values;                ///< parameters x successful samples
  Eigen::VectorXd mean, std, low, high;  ///< central 95 % interval
  /// Frequencies of the solution's pairs, in their order: as the refitted model gives them, and as
  /// the scene gives them before any fit (inputs and priors drawn, the rest at its start).
  struct Frequencies {
    Eigen::VectorXd mean, std, low, high;  ///< Hz
  };
  Frequencies fitted, before;
};

/// Refits from the solution, with its pairs. Drawn anew in each sample, all normal: measured
/// frequencies, damping ratios, FRFs and time histories about the fitted model's (by their
/// uncertainties, the fit's own scatter where they have none), priors, and every input.
/// `progress` is called after each sample, from any thread.
[[nodiscard]] UpdateMonteCarlo update_monte_carlo(const UpdateResult& solution,
                                                  const std::vector<UpdateState>& states,
                                                  const std::vector<FreeParameter>& free,
                                                  const UpdateOptions& options, int samples,
                                                  const std::function<void()>& progress = {});

struct ProfileInterval {
  double low = std::numeric_limits<double>::quiet_NaN();  ///< NaN: open, the cost stays below
  double high = std::numeric_limits<double>::quiet_NaN();
};

/// 95 % intervals by profile: where the least cost with that parameter held, all others fitted
/// anew, exceeds the solution's by half the squared coverage factor (times the variance factor). Of
/// data and priors; inputs and segments are not in it. NaN for what is not identifiable.
/// Source: Bates and Watts, Nonlinear Regression Analysis, 6.1.2.
[[nodiscard]] std::vector<ProfileInterval> profile_intervals(const UpdateResult& solution,
                                                             const std::vector<UpdateState>& states,
                                                             const std::vector<FreeParameter>& free,
                                                             const UpdateOptions& options);

}  // namespace rigfit::ident
