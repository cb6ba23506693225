// Plans which measurements make parameters known to a goal, before anything is measured.
//
// A plan is a set of hammer tests, each in a state of the rig (tension, length), with a hammer,
// with sensors, the first N modes of each plane, hits and the duration of a record. Its information
// on the coordinates q of an update (ln of positive parameters) is
//
//   M = sum_modes (g g' / var(ln f) + h h' / var(ln zeta)) + priors,   g = d ln f / dq, h likewise
//   var(ln f) = 1 / (w^2 sum 1 / var(w)) + model_std^2,   var(ln zeta) = 1 / (a^2 sum 1 / var(a))
//
// with var(w) the Cramer-Rao bound of each hit at each sensor (plan_candidates.h), h only where a
// damping is free, and the inputs that are not fitted as further coordinates: M^-1 is the
// covariance that an update of these modes states.
//
// Steps are chosen one by one: the largest decrease of sum ln(std / goal) over the goals not yet
// reached, per time on the rig (Wynn's greedy exchange; Fedorov, Theory of Optimal Experiments,
// 1972). What no candidate determines is the null space of M without priors.
//
// The prediction is linear and assumes that the scene's values are near the truth, that modes are
// apart, and that every mode is recognised. Masses of further sensors are not added to the rig.
#pragma once

#include "ident/statistics/uncertainty.h"
#include "ident/update/problem/update_data.h"
#include "ident/virtual_rig/virtual_rig.h"
#include "model/linear/natural_mode.h"

namespace rigfit::ident {

/// The standard uncertainty to which a free parameter (of one per state: that of the first) is to
/// be known.
struct PlanGoal {
  std::string parameter;
  double std = 0;        ///< > 0
  bool relative = true;  ///< `std` is relative to the value
};

struct PlanOptions {
  int modes = 6;                           ///< most modes of each plane that a test can identify
  std::vector<double> hits = {5, 10, 20};  ///< averaged hits that a test may have, rising
  std::vector<double> durations_s = {4, 8, 16};  ///< lengths of a record, rising
  int sensors = 3;                               ///< most in one test
  /// False: sensors may also be placed at tenths of members, and hammers and sensors turned along
  /// z.
  bool as_drawn = false;
  double sample_rate_hz = VirtualRigOptions().sample_rate_hz;
  /// Noise of one sample, in the sensors' unit; empty: that of `VirtualInstruments`.
  std::optional<double> noise_std = std::nullopt;
  /// Relative standard uncertainty of the frequency of every mode that is seen in a state, however
  /// often it is measured; 0: by the bound of plan_candidates.h.
  double frequency_relative_std = 0;
  /// Model error, relative in frequency, that no repetition reduces; empty: the scene's accuracy.
  std::optional<double> model_relative_std = std::nullopt;
  /// The same of damping ratios: the least that an update's search allows for
  /// (update_alternatives.h).
  double damping_model_std = 0.01;
  std::vector<UncertainInput> inputs = {};  ///< as in an update
  int threads = 1;
};

/// A mode that the plan measures, as an update will get it.
struct PlannedMode {
  std::size_t state = 0;
  std::string state_name = {};
  VectorXd dlog_frequency, dlog_damping;  ///< d ln f, d ln zeta by coordinate
  model::ModePlane plane = model::ModePlane::in;
  int order = 0;  ///< among the modes of its plane, from 1
  double frequency_hz = 0, damping_ratio = 0;
  double frequency_std = 0, damping_std = 0;  ///< relative, the model's error included

  [[nodiscard]] Estimate frequency() const { return {frequency_hz, frequency_std * frequency_hz}; }
  [[nodiscard]] Estimate damping() const { return {damping_ratio, damping_std * damping_ratio}; }
  static constexpr auto fields() {
    using T = PlannedMode;
    return std::tuple{field("state", &T::state_name), field("plane", &T::plane),
                      field("order", &T::order),
                      field("frequency_hz", &T::frequency, "Hz", "", "as an update will get it"),
                      field("damping_ratio", &T::damping)};
  }
};

/// To what a parameter is known.
struct PlannedStd {
  std::string name;
  double value = 0, std = 0;  ///< NaN: not determined, as below

  [[nodiscard]] double relative_std() const { return std / std::abs(value); }
  static constexpr auto fields() {
    using T = PlannedStd;
    return std::tuple{field("name", &T::name), field("value", &T::value),
                      field("std", &T::std, "", "std", "that is predicted; null: not determined"),
                      field("relative_std", &T::relative_std)};
  }
};

/// One step: a hammer test, or one with a further sensor, more hits or longer records.
struct PlanProposal {
  std::string what;   ///< the test after this step, for a person
  double cost_s = 0;  ///< time on the rig that the step adds
  std::vector<PlannedStd> parameters;

  static constexpr auto fields() {
    using T = PlanProposal;
    return std::tuple{
        field("what", &T::what), field("cost", &T::cost_s, "s", "cost", "on the rig"),
        field("parameters", &T::parameters, "", "", "to what each is known after it")};
  }
};

/// `std`: after all steps.
struct PlannedParameter : PlannedStd {
  double std_before = 0;  ///< by priors alone
  double best_std = 0;    ///< with everything that can be measured

  static constexpr auto fields() {
    using T = PlannedParameter;
    return std::tuple_cat(PlannedStd::fields(),
                          std::tuple{field("std_before", &T::std_before, "", "", "by priors alone"),
                                     field("best_std", &T::best_std, "", "", "with everything")});
  }
};

struct PlannedGoal {
  PlanGoal goal;
  std::size_t parameter = 0;  ///< index
  double wanted_std = 0;      ///< in the parameter's unit
  bool reached = false;
  std::string takes;  ///< what it would take, in words; empty when reached

  [[nodiscard]] const std::string& name() const { return goal.parameter; }
  static constexpr auto fields() {
    using T = PlannedGoal;
    return std::tuple{field("name", &T::name), field("std", &T::wanted_std),
                      field("reached", &T::reached), field("takes", &T::takes)};
  }
};

struct PlanResult {
  std::string failure;  ///< why there is no plan; empty: there is one
  std::vector<PlannedParameter> parameters;
  std::vector<PlanProposal> proposals;
  std::vector<PlannedGoal> goals;
  std::vector<PlannedMode> modes;  ///< what the proposals together identify
  /// What nothing that can be measured separates or determines.
  std::vector<OpenDirection> not_identifiable;
  std::vector<std::string> left_out;  ///< states without an equilibrium

  static constexpr auto fields() {
    using T = PlanResult;
    return std::tuple{field("goals", &T::goals), field("parameters", &T::parameters),
                      field("proposals", &T::proposals), field("modes", &T::modes),
                      field("not_identifiable", &T::not_identifiable)};
  }
};

/// The scene, then with each other tension (N, of all cables) and length (m, of its only member,
/// whose second node moves), in every combination. Throws std::invalid_argument for tensions
/// without a cable that has one, and for lengths of a scene of several members.
[[nodiscard]] std::vector<UpdateState> plan_states(const model::Scene& scene,
                                                   const std::vector<double>& tensions_N,
                                                   const std::vector<double>& lengths_m);

/// `states` from `plan_states`. A parameter whose value differs between them, such as the tension,
/// becomes one per state, its prior relative. Throws std::invalid_argument for a goal that names no
/// free parameter or is not positive, model::SceneError for an unknown parameter.
[[nodiscard]] PlanResult plan_measurements(const std::vector<UpdateState>& states,
                                           std::vector<FreeParameter> free,
                                           const std::vector<PlanGoal>& goals,
                                           const PlanOptions& options = {});

}  // namespace rigfit::ident
