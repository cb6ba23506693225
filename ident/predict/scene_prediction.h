// Predicts modes and FRFs of another scene, with uncertainties, from the parameters of a fit and
// their covariance.
//
// With p the fitted values, C their covariance and y(p) a quantity of the scene,
//
//   var y = g' C g,   g = dy/dp
//
// with analytic derivatives of frequencies, damping ratios and FRFs (the change of the equilibrium
// included). Positive quantities get the interval
// y exp(-+ 1.96 std / y). The linear answer is checked at one and at 1.96 standard uncertainties
// along each principal direction of C: where a frequency departs from it by more than 5 % of its
// std, the modes are sampled instead (positive parameters lognormal), and the interval comes from
// the samples.
//
// The uncertainty contains the fitted parameters and the scene's own inputs that scene_inputs.h
// adds. All other numbers of the scene count as exact. Sources: GUM (JCGM 100:2008), 5; JCGM
// 101:2008 (sampling).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ident/update/problem/update_data.h"
#include "ident/update/problem/update_result.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/scene.h"

namespace rigfit::ident {

/// A fitted parameter, and its name in another scene.
struct KnownParameter {
  std::string name;
  double value = 0;
  /// Scene parameters that take it (model/scene/parameters.h); empty: `name`, or, for a member with
  /// one EI only here or there, EI for EI_z.
  std::vector<std::string> targets = {};
  std::vector<double> factors = {};  ///< one per target; empty: 1
};

/// Change of each parameter of a fit when an input of the fit is larger by one standard
/// uncertainty.
struct InputEffect {
  std::string name;
  Eigen::VectorXd change;  ///< one per parameter
};

struct FittedParameters {
  std::vector<KnownParameter> parameters;
  Eigen::MatrixXd covariance;  ///< parameters x parameters, finite
  std::vector<InputEffect> inputs = {};
};

/// Sets the effect of an input on a parameter, which is counted from 0.
void add_effect(const std::string& input, Eigen::Index parameter, double change,
                FittedParameters& fitted);

/// Values and covariance of the parameters that a fit identified.
[[nodiscard]] FittedParameters fitted_parameters(const UpdateResult& fit,
                                                 const std::vector<FreeParameter>& free);

struct PredictionOptions {
  int count = 6;                     ///< modes
  std::optional<int> segments = {};  ///< for every member; else the scene's
  int samples = 200;                 ///< draws, where the linear answer does not hold
  bool always_sample = false;
  std::uint64_t seed = 1;
};

struct PredictedMode {
  model::NaturalMode mode;  ///< at the fitted values
  signal::Estimate frequency_hz, damping_ratio;
  double low_hz = 0, high_hz = 0;  ///< 95 %
};

struct ModePrediction {
  model::Equilibrium equilibrium;    ///< no modes unless converged
  std::vector<PredictedMode> modes;  ///< by rising frequency
  Eigen::MatrixXd covariance;        ///< frequencies, to first order, Hz^2
  double nonlinearity = 0;  ///< largest departure from the linear answer, in standard uncertainties
  bool sampled = false;     ///< std and intervals come from samples
  std::vector<std::string> used, not_used;  ///< names of parameters
  model::Scene scene;                       ///< with the fitted values
};

/// The scene with the values in it; names that match into `used`, others into `not_used`. Throws
/// model::SceneError for a target that the scene does not have.
[[nodiscard]] model::Scene scene_with(const model::Scene& scene, const FittedParameters& fitted,
                                      std::vector<std::string>& used,
                                      std::vector<std::string>& not_used);

/// Throws std::invalid_argument when no parameter is one of the scene's: the message names both.
[[nodiscard]] ModePrediction predict_modes(const model::Scene& scene,
                                           const FittedParameters& fitted,
                                           const PredictionOptions& options = {});

struct FrfPrediction {
  Eigen::VectorXd frequency_hz;
  std::vector<Eigen::MatrixXcd> H;   ///< per line: sensors x loads
  std::vector<Eigen::MatrixXd> std;  ///< standard uncertainty of ln |H|, first order
};
/// Throws like predict_modes.
[[nodiscard]] FrfPrediction predict_frfs(const model::Scene& scene, const FittedParameters& fitted,
                                         const Eigen::VectorXd& frequency_hz);

/// A measured frequency compared with a prediction.
struct HeldAgainst {
  std::size_t measured = 0;
  int mode = -1;  ///< index in the prediction; -1: not paired
  double relative_error =
      std::numeric_limits<double>::quiet_NaN();  ///< predicted over measured - 1
  /// Difference over the standard uncertainty of both together.
  double standard_units = std::numeric_limits<double>::quiet_NaN();
  bool inside = false;  ///< the measured frequency in the predicted 95 % interval
};

/// Pairs by frequency, and plane where the test names one (mode_pairing.h).
[[nodiscard]] std::vector<HeldAgainst> held_against(const ModePrediction& prediction,
                                                    const std::vector<MeasuredMode>& measured);

}  // namespace rigfit::ident
