// Options and result of a plan of measurements.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

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
  double state_s = 600;                     ///< time to set another tension or length
  double place_s = 60;                      ///< time to place a sensor or to move the hammer
  std::vector<UncertainInput> inputs = {};  ///< as in an update
  int threads = 1;
};

/// A mode that the plan measures, as an update will get it.
struct PlannedMode {
  std::size_t state = 0;
  Eigen::VectorXd dlog_frequency, dlog_damping;  ///< d ln f, d ln zeta by coordinate
  model::ModePlane plane = model::ModePlane::in;
  int order = 0;  ///< among the modes of its plane, from 0
  double frequency_hz = 0, damping_ratio = 0;
  double frequency_std = 0, damping_std = 0;  ///< relative, the model's error included
};

/// One step: a hammer test, or one with a further sensor, more hits or longer records.
struct PlanProposal {
  std::string what;         ///< the test after this step, for a person
  double cost_s = 0;        ///< time on the rig that the step adds
  std::vector<double> std;  ///< for every parameter after it; NaN: not determined
};

struct PlannedParameter {
  std::string name;
  double value = 0;
  double std_before = 0;  ///< by priors alone; NaN: not determined, as below
  double std = 0;         ///< after all steps
  double best_std = 0;    ///< with everything that can be measured
};

struct PlannedGoal {
  PlanGoal goal;
  std::size_t parameter = 0;  ///< index
  double wanted_std = 0;      ///< in the parameter's unit
  bool reached = false;
  std::string takes;  ///< what it would take, in words; empty when reached
};

struct PlanResult {
  std::string failure;  ///< why there is no plan; empty: there is one
  std::vector<PlannedParameter> parameters;
  std::vector<PlanProposal> proposals;
  std::vector<PlannedGoal> goals;
  std::vector<PlannedMode> modes;  ///< what the proposals together identify
  /// What nothing that can be measured separates or determines; indices of `parameters`.
  std::vector<OpenDirection> not_identifiable;
  std::vector<std::string> left_out;  ///< states without an equilibrium
};

}  // namespace rigfit::ident
