// Predicts the modes of another scene, with uncertainties, from the parameters of a fit and their
// covariance.
//
// With p the fitted values, C their covariance, u_k the principal directions of C (one standard
// uncertainty long) and y(p) ln of a frequency or a damping ratio,
//
//   y_k+- = y(p +- 1.96 u_k),   var y = sum_k ((y_k+ - y_k-) / 3.92)^2,
//   95 %: from y - root(sum_k (y - min(y_k+, y_k-, y))^2) to its counterpart above
//
// which is linear propagation where y is linear, and exact for one parameter wherever y is
// monotone; positive parameters move in their logarithm.
//
// The uncertainty contains the fitted parameters and the scene's own inputs that `add_scene_inputs`
// adds. All other numbers of the scene count as exact. Source: GUM (JCGM 100:2008), 5.
#pragma once

#include "ident/statistics/finding.h"
#include "ident/statistics/uncertainty.h"
#include "ident/update/problem/update_data.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/scene.h"

namespace rigfit::ident {

/// A fitted parameter, and its name in another scene.
struct KnownParameter {
  std::string name;
  double value = 0;
  /// Scene parameters that take it (model/scene/parameters.h), or one "" where none does; empty:
  /// `name`, or, for a member with one EI only here or there, EI for EI_z.
  std::vector<std::string> targets = {};
  std::vector<double> factors = {};  ///< one per target; empty: 1
};

struct FittedParameters {
  std::vector<KnownParameter> parameters;
  MatrixXd covariance;  ///< parameters x parameters, finite
  /// Change of each parameter when an input of the fit, by its name, is larger by one standard
  /// uncertainty.
  std::map<std::string, VectorXd> inputs = {};
};

/// Sets the effect of an input on a parameter, which is counted from 0.
void add_effect(const std::string& input, Index parameter, double change, FittedParameters& fitted);

struct PredictionOptions {
  int count = 6;                     ///< modes
  std::optional<int> segments = {};  ///< for every member; else the scene's
};

struct PredictedMode {
  model::NaturalMode mode;  ///< at the fitted values
  BoundedEstimate frequency_hz;
  Estimate damping_ratio;

  [[nodiscard]] describe::Ends interval() const {
    return {frequency_hz.low, frequency_hz.high, frequency_hz.std};
  }
  static constexpr auto fields() {
    using T = PredictedMode;
    return std::tuple{
        field("frequency_hz", &T::frequency_hz, "Hz", "frequency", "with its 95 % interval"),
        field("", &T::interval, "Hz", "95 % interval", ""),
        field("damping_ratio", &T::damping_ratio),
        field("plane", describe::within(&T::mode, &model::NaturalMode::plane), "", "plane", ""),
        field("family", describe::within(&T::mode, &model::NaturalMode::family), "", "family", ""),
        field("kinetic_energy", describe::within(&T::mode, &model::NaturalMode::kinetic_energy))};
  }
};

struct ModePrediction {
  model::Equilibrium equilibrium;           ///< no modes unless converged
  std::vector<PredictedMode> modes;         ///< by rising frequency
  std::vector<std::string> used, not_used;  ///< names of parameters
  model::Scene scene;                       ///< with the fitted values
};

/// An input of a scene that is known to an uncertainty, beside the parameters of a fit: a tip mass,
/// a length, a mass per length that a prediction would otherwise take as exact.
struct SceneInput {
  std::string name;                  ///< a parameter of the scene
  std::optional<double> value = {};  ///< not given: the scene's own
  double std = 0;                    ///< > 0
  bool relative = false;             ///< `std` is relative to the value
  bool of_fit = false;               ///< once added: an input of the fit as well
  bool fitted = false;               ///< a parameter of the fit: not added

  static constexpr auto fields() {
    using T = SceneInput;
    return std::tuple{field("name", &T::name), field("value", &T::value), field("std", &T::std),
                      field("shared_with_fit", &T::of_fit)};
  }
};

/// Adds the inputs to `fitted` as parameters; returns them with their value and its std. With p the
/// fit's parameters and x the inputs the joint covariance is cov(p, p) = C, cov(x, x) = s^2, cov(p,
/// x) = change s, where `change` is by how much p moves with one standard uncertainty of the input
/// in the fit, if the fit had an input of that name (it is then the same quantity, and what C holds
/// of it counts once), else 0. An input that the fit found as a parameter keeps the fit's value and
/// covariance (GUM, 5.2). Throws model::SceneError for a name that the scene does not have,
/// std::invalid_argument for an uncertainty that is not positive and finite.
std::vector<SceneInput> add_scene_inputs(const model::Scene& scene, std::vector<SceneInput> inputs,
                                         FittedParameters& fitted);

/// "input_is_fitted" for each state of the scene's rig (tension, stretch, unstretched length,
/// temperature) that lies outside the 95 % interval of the fit's parameter that replaces it. Throws
/// std::invalid_argument for a target that the scene does not have, as all of these.
[[nodiscard]] std::vector<Finding> replaced_states(const model::Scene& scene,
                                                   const FittedParameters& fitted);

/// Throws std::invalid_argument when no parameter is one of the scene's: the message names both.
[[nodiscard]] ModePrediction predict_modes(const model::Scene& scene,
                                           const FittedParameters& fitted,
                                           const PredictionOptions& options = {});

/// A measured frequency compared with a prediction.
struct HeldAgainst {
  Estimate measured_hz;
  int mode = -1;  ///< index in the prediction; -1: not paired, and what follows is NaN
  Estimate predicted_hz{kNaN, kNaN};
  double relative_error = kNaN;  ///< predicted over measured - 1
  bool inside = false;           ///< the measured frequency in the predicted 95 % interval

  [[nodiscard]] bool paired() const { return mode >= 0; }
  [[nodiscard]] int number() const { return mode + 1; }
  [[nodiscard]] Estimate error() const {
    const double std = std::isfinite(measured_hz.std) ? measured_hz.std : 0;
    return {relative_error, std::hypot(std, predicted_hz.std) / measured_hz.value};
  }
  static constexpr auto fields() {
    using T = HeldAgainst;
    using describe::where, describe::within;
    return std::tuple{field("", &T::measured_hz, "Hz", "measured", ""),
                      field("", &T::predicted_hz, "Hz", "predicted", ""),
                      field("measured_hz", within(&T::measured_hz, &Estimate::value)),
                      field("measured_std_hz", within(&T::measured_hz, &Estimate::std)),
                      field("mode", where(&T::paired, &T::number)),
                      field("predicted_hz", within(&T::predicted_hz, &Estimate::value)),
                      field("", where(&T::paired, &T::error), "%", "error", ""),
                      field("relative_error", &T::relative_error),
                      field("inside", where(&T::paired, &T::inside), "", "in 95 %", "")};
  }
};

/// In the order of `measured`. Pairs by frequency, and plane where the test names one
/// (mode_assignment.h).
[[nodiscard]] std::vector<HeldAgainst> held_against(const ModePrediction& prediction,
                                                    const std::vector<MeasuredMode>& measured);

}  // namespace rigfit::ident
