// Input of an update: free parameters, inputs with their uncertainty, the measurements in each
// state of the rig, and options.
#pragma once

#include "ident/update/pairing/mode_assignment.h"
#include "model/linear/modal_analysis.h"

namespace rigfit::ident {

struct FreeParameter {
  std::string name;  ///< for people and results
  /// Scene parameters (see model::parameter) that all take this value; empty: `name` itself.
  std::vector<std::string> targets = {};
  /// Factor from the value to each target, such as -1 for the other end of a symmetric rig;
  /// empty: 1.
  std::vector<double> factors = {};
  bool per_state = false;                        ///< a value of its own in every state
  std::optional<double> start = std::nullopt;    ///< empty: the scene's value
  std::optional<Estimate> prior = std::nullopt;  ///< from an earlier test
  /// Without `prior`: relative standard uncertainty of a prior at the scene's own value (in each
  /// state if `per_state`), such as a load cell's reading; 0: no prior.
  double prior_relative_std = 0;
  double low = -std::numeric_limits<double>::infinity();  ///< bounds; positive parameters always
                                                          ///< stay positive
  double high = std::numeric_limits<double>::infinity();

  [[nodiscard]] std::vector<std::string> all_targets() const {
    return targets.empty() ? std::vector{name} : targets;
  }
  [[nodiscard]] double factor(std::size_t target) const {
    return target < factors.size() ? factors[target] : 1;
  }
};

/// An uncertain number that is not fitted: a load cell's reading, a length, a mass, an EI from a
/// bending test. One standard uncertainty of it changes numbers of the scenes by `change`.
struct UncertainInput {
  struct Effect {
    int state = 0;
    std::string target;  ///< scene parameter; has no effect on a fitted one
    double change = 0;   ///< by one standard uncertainty
  };
  std::string name;
  std::vector<Effect> effects = {};
};

/// Target of an UncertainInput's effect that stands for all measured frequencies of the state
/// (modes and FRF lines) instead of a scene parameter; the change is relative.
inline constexpr std::string_view kSampleRateTarget = "sample rate";

struct MeasuredMode {
  Estimate frequency_hz;                                 ///< std not finite: unknown
  Estimate damping_ratio;                                ///< value not finite: not measured
  std::optional<model::ModePlane> plane = std::nullopt;  ///< plane of the test
  VectorXcd shape = {};  ///< at the scene's sensors, in their order; empty: not measured
  int order = 0;         ///< among the modes of its plane, from 1; 0: not stated
};

/// One measured FRF, from a load of the scene to a sensor of it, in the sensor's quantity per N.
struct MeasuredFrf {
  std::size_t sensor = 0, load = 0;  ///< indices in the scene
  VectorXd frequency_hz;             ///< positive
  VectorXcd H;
  VectorXd std = {};  ///< std of the real and of the imaginary part; empty: unknown
  /// Decay rate of an exponential window on force and response. The model is evaluated at
  /// s = i omega + decay_rate (model/frfs/frf_synthesis.h), so that the window's damping is not
  /// fitted.
  double decay_rate_1_s = 0;
  /// Number of lines that count as one, since neighbouring lines share their noise under a window
  /// (`lines_per_independent` below).
  double lines_per_independent = 1;
};

/// Noise bandwidth of the window exp(-a t) over a block of duration T, in lines of 1/T:
/// (a T / 2) coth(a T / 2). Source: F. J. Harris, Proc. IEEE 66 (1978)
/// 51-83, equivalent noise bandwidth.
[[nodiscard]] double lines_per_independent(double decay_rate_1_s, double line_spacing_hz);

/// The rig in one state: its scene as known before, and the measurements.
struct UpdateState {
  std::string name;
  model::Scene scene;
  std::vector<MeasuredMode> measured;
  std::vector<MeasuredFrf> frfs = {};
  /// True if the modes were identified from these FRFs: they give starting values and are listed,
  /// but do not count as data a second time.
  bool modes_lead_only = false;
  /// Relative standard uncertainty of the sample rate of the recordings (signal::Recording::
  /// sample_rate_relative_std: a step printed with few digits). An analyser has one clock: its
  /// error is common to all frequencies of all states, an input named "sample rate". The
  /// frequencies' own standard uncertainties exclude it.
  double clock_relative_std = 0;
  /// Band of the test of `measured`; empty: from 0 to the highest measured mode.
  std::optional<std::pair<double, double>> band_hz = std::nullopt;
};

/// The defaults suit most fits.
struct UpdateOptions {
  /// Relative standard uncertainty of frequencies that come without one. It only sets their weight;
  /// the scatter about the fit gives the variance.
  double assumed_relative_std = 0.01;
  /// Model error, relative in frequency, added to every measured uncertainty.
  double model_relative_std = 0;
  AssignmentOptions assignment = {};
  /// 1: finds the answer near the scene's own values. More: fits to modes search the whole range of
  /// the parameters (update_alternatives.h), fits of FRFs that of their modes.
  int starts = 4;
  int threads = 1;  ///< work on starts in parallel
  /// True: the error of "auto" segments is subtracted from frequencies (update_segments.cc). False:
  /// the data come from a model with these segments.
  bool segment_uncertainty = true;
  std::vector<UncertainInput> inputs = {};  ///< independent of each other
  /// Segments of "auto" members; FRFs get more where they need them.
  int auto_segments = 30;
  bool hold_out = false;  ///< predict each state from the others, where there are several
  /// Free parameters, the first of them, whose intervals may be profiles; others are linear.
  int profiled = std::numeric_limits<int>::max();
};

}  // namespace rigfit::ident
