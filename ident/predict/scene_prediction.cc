#include "ident/predict/scene_prediction.h"

#include <gsl/gsl_statistics_double.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <random>
#include <stdexcept>

#include "ident/update/pairing/mode_assignment.h"
#include "model/frfs/frf_sensitivities.h"
#include "model/scene/parameters.h"
#include "signal/estimation/robust.h"

namespace rigfit::ident {
namespace {

constexpr double kCoverage = 1.959964;  // normal density, 95 %
constexpr double kLinear = 0.05;        // departure in standard uncertainties that needs samples

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// What a parameter sets in a scene: its targets that are there.
struct Mapped {
  std::vector<std::string> targets;
  std::vector<double> factors;
};

Mapped mapped(const KnownParameter& parameter, const std::vector<std::string>& names) {
  Mapped found;
  if (!parameter.targets.empty()) {
    for (std::size_t i = 0; i < parameter.targets.size(); ++i) {
      if (!has(names, parameter.targets[i])) continue;
      found.targets.push_back(parameter.targets[i]);
      found.factors.push_back(i < parameter.factors.size() ? parameter.factors[i] : 1);
    }
    if (!found.targets.empty()) return found;
  }
  std::string name = parameter.name;
  if (!has(names, name) && name.ends_with(".EI_z")) name.resize(name.size() - 2);
  if (!has(names, name) && name.ends_with(".EI")) name += "_z";
  if (has(names, name)) found = {{name}, {1}};
  return found;
}

/// The parameters that a scene has, with the targets that each moves.
struct Selection {
  std::vector<Mapped> maps;
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;
  std::vector<std::string> used, not_used;

  /// Every target once, and d target / d parameter.
  [[nodiscard]] std::vector<std::string> targets() const {
    std::vector<std::string> all;
    for (const auto& map : maps) all.insert(all.end(), map.targets.begin(), map.targets.end());
    return all;
  }
  [[nodiscard]] Eigen::MatrixXd rates() const {
    Eigen::MatrixXd rate =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(targets().size()), value.size());
    Eigen::Index row = 0;
    for (std::size_t p = 0; p < maps.size(); ++p) {
      for (const double factor : maps[p].factors)
        rate(row++, static_cast<Eigen::Index>(p)) = factor;
    }
    return rate;
  }
  [[nodiscard]] model::Scene scene(model::Scene base, const Eigen::VectorXd& values) const {
    for (std::size_t p = 0; p < maps.size(); ++p) {
      for (std::size_t t = 0; t < maps[p].targets.size(); ++t) {
        model::set_parameter(base, maps[p].targets[t],
                             maps[p].factors[t] * values[static_cast<Eigen::Index>(p)]);
      }
    }
    return base;
  }
};

Selection select(const model::Scene& scene, const FittedParameters& fitted) {
  const auto names = model::parameter_names(scene);
  Selection selection;
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < fitted.parameters.size(); ++i) {
    const auto& parameter = fitted.parameters[i];
    auto map = mapped(parameter, names);
    if (map.targets.empty()) {
      selection.not_used.push_back(parameter.name);
      continue;
    }
    selection.used.push_back(parameter.name);
    selection.maps.push_back(std::move(map));
    kept.push_back(static_cast<Eigen::Index>(i));
  }
  if (kept.empty()) {
    std::string said = "no parameter of the fit is one of this scene's: the fit has";
    for (const auto& parameter : fitted.parameters) said += " \"" + parameter.name + "\"";
    said += "; the scene has";
    for (const auto& name : names) said += " \"" + name + "\"";
    throw std::invalid_argument(said);
  }
  const auto n = static_cast<Eigen::Index>(kept.size());
  selection.value.resize(n);
  selection.covariance.resize(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto from = kept[static_cast<std::size_t>(i)];
    selection.value[i] = fitted.parameters[static_cast<std::size_t>(from)].value;
    for (Eigen::Index j = 0; j < n; ++j) {
      selection.covariance(i, j) = fitted.covariance(from, kept[static_cast<std::size_t>(j)]);
    }
  }
  return selection;
}

model::ModesOptions modes_options(const PredictionOptions& options, bool shapes) {
  model::ModesOptions modes;
  modes.count = options.count;
  modes.segments = options.segments;
  modes.shapes = shapes;
  modes.error_estimate = false;
  return modes;
}

/// Every member leaves its segments to the program.
bool all_auto(const model::Scene& scene, const model::ModesOptions& options) {
  return std::all_of(scene.members.begin(), scene.members.end(), [&](const auto& member) {
    return options.segments.value_or(member.segments) <= 0;
  });
}

constexpr double kRateAccuracy = 1e-4;  // relative, frequencies of the chain for derivatives

/// Modes and their derivatives. Where a scene leaves its segments to the program, `analyse_modes`
/// gives the frequencies, many times cheaper than one chain as accurate, and a chain accurate to
/// 1e-4 gives the derivatives.
model::ModeSensitivities nominal_modes(const model::Scene& scene,
                                       const std::vector<std::string>& targets,
                                       const model::ModesOptions& options) {
  if (!all_auto(scene, options)) return model::analyse_mode_sensitivities(scene, targets, options);
  model::Scene rough = scene;
  rough.accuracy = std::max(scene.accuracy, kRateAccuracy);
  model::ModeSensitivities found = model::analyse_mode_sensitivities(rough, targets, options);
  model::ModalAnalysis fine = model::analyse_modes(scene, options);
  const std::size_t count = found.analysis.modes.size();
  if (fine.modes.size() != count) return model::analyse_mode_sensitivities(scene, targets, options);
  // Modes of unlike planes that lie on each other may change places.
  const model::ModeSensitivities one = found;
  std::vector<bool> taken(count, false);
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t k = 0;
    while (k < count && (taken[k] || one.analysis.modes[k].plane != fine.modes[i].plane)) ++k;
    if (k == count) return model::analyse_mode_sensitivities(scene, targets, options);
    taken[k] = true;
    const auto to = static_cast<Eigen::Index>(i), from = static_cast<Eigen::Index>(k);
    const double ratio = fine.modes[i].frequency_hz / one.analysis.modes[k].frequency_hz;
    found.frequency.row(to) = ratio * one.frequency.row(from);
    found.damping_ratio.row(to) = one.damping_ratio.row(from);
  }
  found.analysis = std::move(fine);
  return found;
}

/// Independent moves of one standard uncertainty each, as columns.
Eigen::MatrixXd directions_of(const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

/// `base` with the parameters moved; those that are positive stay so.
model::Scene moved(const model::Scene& base, const Selection& selection,
                   const Eigen::VectorXd& change) {
  Eigen::VectorXd values = selection.value;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    values[i] = values[i] > 0 ? values[i] * std::exp(change[i] / values[i]) : values[i] + change[i];
  }
  return selection.scene(base, values);
}

/// Vectors of independent standard normal numbers.
class NormalDraws {
 public:
  explicit NormalDraws(std::uint64_t seed) : random_(seed) {}
  Eigen::VectorXd operator()(Eigen::Index size) {
    Eigen::VectorXd unit(size);
    for (auto& value : unit) value = normal_(random_);
    return unit;
  }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

/// Frequencies of moved scenes, of the same modes as a prediction's.
struct Draws {
  std::vector<model::NaturalMode> reference;
  std::vector<int> orders;  // place of each among those of its plane
  model::ModesOptions options;
  double accuracy = 1e-3;

  /// Scenes that leave their segments to the program: a hundredth of the least std of a frequency,
  /// by the linear answer, within reasonable bounds.
  Draws(const ModePrediction& prediction, const PredictionOptions& asked)
      : options(modes_options(asked, false)) {
    constexpr double kShare = 0.01, kLeast = 1e-7;
    options.damped = false;
    std::map<model::ModePlane, int> seen;
    for (const auto& mode : prediction.modes) {
      reference.push_back(mode.mode);
      orders.push_back(seen[mode.mode.plane]++);
      const double relative = mode.frequency_hz.std / mode.frequency_hz.value;
      if (relative > 0) accuracy = std::min(accuracy, std::max(kShare * relative, kLeast));
    }
  }
  /// Empty where the scene has no equilibrium or lacks one of the modes.
  [[nodiscard]] Eigen::VectorXd of(const model::Scene& scene) const {
    model::ModesOptions own = options;
    if (all_auto(scene, options)) own.accuracy = accuracy;
    std::map<model::ModePlane, std::vector<double>> hz;
    for (const auto& mode : model::analyse_modes(scene, own).modes) {
      hz[mode.plane].push_back(mode.frequency_hz);
    }
    Eigen::VectorXd found(static_cast<Eigen::Index>(reference.size()));
    for (std::size_t i = 0; i < reference.size(); ++i) {
      const auto& list = hz[reference[i].plane];
      const auto order = static_cast<std::size_t>(orders[i]);
      if (order >= list.size()) return {};
      found[static_cast<Eigen::Index>(i)] = list[order];
    }
    return found;
  }
};

/// Largest departure of a frequency from ln f + g' dp / f, over its std.
double nonlinearity(const model::Scene& scene, const Selection& selection,
                    const Eigen::MatrixXd& directions, const Eigen::MatrixXd& gradient,
                    const ModePrediction& prediction, const Draws& draws) {
  const Eigen::VectorXd here = draws.of(prediction.scene);
  if (here.size() == 0) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (Eigen::Index k = 0; k < directions.cols(); ++k) {
    if (!(directions.col(k).norm() > 0)) continue;
    for (const double size : {-kCoverage, -1.0, 1.0, kCoverage}) {
      const Eigen::VectorXd change = size * directions.col(k);
      const Eigen::VectorXd found = draws.of(moved(scene, selection, change));
      if (found.size() == 0) return std::numeric_limits<double>::infinity();
      for (Eigen::Index i = 0; i < found.size(); ++i) {
        const auto& f = prediction.modes[static_cast<std::size_t>(i)].frequency_hz;
        if (!(f.std > 0)) continue;
        const double linear = gradient.row(i).dot(change) / f.value;
        const double off = std::log(found[i] / here[i]) - linear;
        worst = std::max(worst, std::abs(off) * f.value / f.std);
      }
    }
  }
  return worst;
}

/// Std and interval of each frequency from samples.
void sample(const model::Scene& scene, const Selection& selection,
            const Eigen::MatrixXd& directions, const PredictionOptions& options, const Draws& draws,
            ModePrediction& prediction) {
  NormalDraws draw(options.seed);
  std::vector<std::vector<double>> all(prediction.modes.size());
  for (int s = 0; s < options.samples; ++s) {
    const Eigen::VectorXd change = directions * draw(directions.cols());
    const Eigen::VectorXd found = draws.of(moved(scene, selection, change));
    for (Eigen::Index i = 0; i < found.size(); ++i) {
      all[static_cast<std::size_t>(i)].push_back(found[i]);
    }
  }
  prediction.sampled = true;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto& values = all[i];
    if (values.size() < 20) continue;
    auto& mode = prediction.modes[i];
    mode.frequency_hz.std = gsl_stats_sd(values.data(), 1, values.size());
    mode.low_hz = signal::quantile(values, 0.025);
    mode.high_hz = signal::quantile(values, 0.975);
  }
}

}  // namespace

void add_effect(const std::string& input, Eigen::Index parameter, double change,
                FittedParameters& fitted) {
  const auto size = static_cast<Eigen::Index>(fitted.parameters.size());
  auto at = std::find_if(fitted.inputs.begin(), fitted.inputs.end(),
                         [&](const InputEffect& one) { return one.name == input; });
  if (at == fitted.inputs.end()) {
    at = fitted.inputs.insert(at, {input, Eigen::VectorXd::Zero(size)});
  }
  at->change[parameter] = change;
}

FittedParameters fitted_parameters(const UpdateResult& fit,
                                   const std::vector<FreeParameter>& free) {
  FittedParameters fitted;
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const auto& parameter = fit.parameters[i];
    if (!parameter.identifiable || parameter.state > 0) continue;
    KnownParameter known{parameter.name, parameter.value};
    for (const auto& one : free) {
      if (one.name != parameter.name) continue;
      known.targets = one.targets;
      known.factors = one.factors;
    }
    fitted.parameters.push_back(std::move(known));
    kept.push_back(static_cast<Eigen::Index>(i));
  }
  const auto n = static_cast<Eigen::Index>(kept.size());
  fitted.covariance.resize(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const double value =
          fit.covariance(kept[static_cast<std::size_t>(i)], kept[static_cast<std::size_t>(j)]);
      fitted.covariance(i, j) = std::isfinite(value) ? value : 0;
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for (const auto& term :
         fit.parameters[static_cast<std::size_t>(kept[static_cast<std::size_t>(i)])].budget) {
      if (std::isfinite(term.change)) add_effect(term.source, i, term.change, fitted);
    }
  }
  return fitted;
}

std::vector<AddedInput> add_scene_inputs(const model::Scene& scene,
                                         const std::vector<SceneInput>& inputs,
                                         FittedParameters& fitted) {
  std::vector<AddedInput> added;
  added.reserve(inputs.size());
  const auto of_fit = static_cast<Eigen::Index>(fitted.parameters.size());
  for (const auto& input : inputs) {
    AddedInput one{input.name, input.value.value_or(model::parameter(scene, input.name)),
                   input.std};
    if (input.relative) one.std *= std::abs(one.value);
    if (!(one.std > 0) || !std::isfinite(one.std) || !std::isfinite(one.value)) {
      throw std::invalid_argument("the uncertainty of " + input.name + " is not positive");
    }
    for (const auto& parameter : fitted.parameters) {
      const auto& targets = parameter.targets;
      one.fitted = one.fitted || parameter.name == input.name ||
                   std::find(targets.begin(), targets.end(), input.name) != targets.end();
    }
    if (!one.fitted) {
      const auto n = static_cast<Eigen::Index>(fitted.parameters.size());
      fitted.parameters.push_back({input.name, one.value});
      fitted.covariance.conservativeResize(n + 1, n + 1);
      fitted.covariance.row(n).setZero();
      fitted.covariance.col(n).setZero();
      fitted.covariance(n, n) = one.std * one.std;
      for (const auto& effect : fitted.inputs) {
        if (effect.name != input.name) continue;
        one.of_fit = true;
        fitted.covariance.col(n).head(of_fit) = one.std * effect.change.head(of_fit);
        fitted.covariance.row(n) = fitted.covariance.col(n).transpose();
      }
    }
    added.push_back(one);
  }
  return added;
}

ModePrediction predict_modes(const model::Scene& scene, const FittedParameters& fitted,
                             const PredictionOptions& options) {
  const auto selection = select(scene, fitted);
  ModePrediction prediction;
  prediction.used = selection.used;
  prediction.not_used = selection.not_used;
  prediction.scene = selection.scene(scene, selection.value);
  const auto found =
      nominal_modes(prediction.scene, selection.targets(), modes_options(options, true));
  prediction.equilibrium = found.analysis.equilibrium;
  if (found.analysis.modes.empty()) return prediction;
  const Eigen::MatrixXd rates = selection.rates();
  const Eigen::MatrixXd gradient = found.frequency * rates;
  const Eigen::MatrixXd of_damping = found.damping_ratio * rates;
  prediction.covariance = gradient * selection.covariance * gradient.transpose();
  for (std::size_t i = 0; i < found.analysis.modes.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    PredictedMode mode;
    mode.mode = found.analysis.modes[i];
    const double f = mode.mode.frequency_hz;
    const double std = std::sqrt(std::max(0.0, prediction.covariance(k, k)));
    mode.frequency_hz = {f, std};
    const double damping_variance =
        of_damping.rows() > k
            ? (of_damping.row(k) * selection.covariance * of_damping.row(k).transpose()).value()
            : 0;
    mode.damping_ratio = {mode.mode.damping_ratio, std::sqrt(std::max(0.0, damping_variance))};
    mode.low_hz = f * std::exp(-kCoverage * std / f);
    mode.high_hz = f * std::exp(kCoverage * std / f);
    prediction.modes.push_back(std::move(mode));
  }
  const Eigen::MatrixXd directions = directions_of(selection.covariance);
  const Draws draws(prediction, options);
  prediction.nonlinearity = nonlinearity(scene, selection, directions, gradient, prediction, draws);
  if (options.always_sample || prediction.nonlinearity > kLinear) {
    sample(scene, selection, directions, options, draws, prediction);
  }
  return prediction;
}

FrfPrediction predict_frfs(const model::Scene& scene, const FittedParameters& fitted,
                           const Eigen::VectorXd& frequency_hz) {
  const auto selection = select(scene, fitted);
  const auto found = model::synthesize_frf_sensitivities(selection.scene(scene, selection.value),
                                                         frequency_hz, selection.targets());
  FrfPrediction prediction;
  prediction.frequency_hz = frequency_hz;
  prediction.H = found.frfs.H;
  const Eigen::MatrixXd rates = selection.rates();
  const std::size_t lines = found.frfs.H.size();
  for (std::size_t line = 0; line < lines; ++line) {
    const auto& H = found.frfs.H[line];
    Eigen::MatrixXd std(H.rows(), H.cols());
    for (Eigen::Index s = 0; s < H.rows(); ++s) {
      for (Eigen::Index l = 0; l < H.cols(); ++l) {
        Eigen::VectorXd of_target(rates.rows());
        for (Eigen::Index t = 0; t < rates.rows(); ++t) {
          // d ln |H| = Re(dH / H)
          const auto rate = found.rate[static_cast<std::size_t>(t)][line](s, l);
          of_target[t] = std::abs(H(s, l)) > 0 ? (rate / H(s, l)).real() : 0;
        }
        const Eigen::VectorXd g = rates.transpose() * of_target;
        std(s, l) = std::sqrt(std::max(0.0, g.dot(selection.covariance * g)));
      }
    }
    prediction.std.push_back(std::move(std));
  }
  return prediction;
}

ResponsePrediction predict_response(const model::Scene& scene, const FittedParameters& fitted,
                                    const ResponsePredictionOptions& options) {
  constexpr int kFewestDraws = 40;  // the 2.5 % quantile then lies inside of the draws
  const auto selection = select(scene, fitted);
  ResponsePrediction prediction;
  prediction.used = selection.used;
  prediction.not_used = selection.not_used;
  prediction.response =
      model::simulate_response(selection.scene(scene, selection.value), options.response);
  if (!prediction.response.completed) return prediction;
  const Eigen::MatrixXd directions = directions_of(selection.covariance);
  auto wanted = options.response;
  wanted.solver = prediction.response.solver;
  const auto& at_fit = prediction.response.samples;
  NormalDraws draw(options.seed);
  std::vector<Eigen::MatrixXd> all;
  for (int s = 0; s < options.samples; ++s) {
    const Eigen::VectorXd change = directions * draw(directions.cols());
    auto one = model::simulate_response(moved(scene, selection, change), wanted);
    if (one.completed && one.samples.rows() == at_fit.rows() && one.samples.allFinite()) {
      all.push_back(std::move(one.samples));
    }
  }
  prediction.samples = static_cast<int>(all.size());
  if (prediction.samples < kFewestDraws) return prediction;
  prediction.low.resizeLike(at_fit);
  prediction.high.resizeLike(at_fit);
  std::vector<double> values(all.size());
  for (Eigen::Index i = 0; i < at_fit.size(); ++i) {
    std::transform(all.begin(), all.end(), values.begin(),
                   [&](const auto& one) { return one.data()[i]; });
    std::sort(values.begin(), values.end());
    prediction.low.data()[i] =
        gsl_stats_quantile_from_sorted_data(values.data(), 1, values.size(), 0.025);
    prediction.high.data()[i] =
        gsl_stats_quantile_from_sorted_data(values.data(), 1, values.size(), 0.975);
  }
  return prediction;
}

std::vector<HeldAgainst> held_against(const ModePrediction& prediction,
                                      const std::vector<MeasuredMode>& measured) {
  std::vector<PairingMode> tested, modelled;
  for (const auto& mode : measured) {
    PairingMode one;
    one.frequency_hz = mode.frequency_hz.value;
    one.plane = mode.plane;
    tested.push_back(std::move(one));
  }
  for (const auto& mode : prediction.modes) {
    PairingMode one;
    one.frequency_hz = mode.frequency_hz.value;
    one.plane = mode.mode.plane;
    modelled.push_back(std::move(one));
  }
  std::vector<HeldAgainst> all(measured.size());
  for (std::size_t i = 0; i < measured.size(); ++i) all[i].measured = i;
  for (const auto& pair : pair_modes(tested, modelled)) {
    auto& one = all[static_cast<std::size_t>(pair.measured)];
    const auto& mode = prediction.modes[static_cast<std::size_t>(pair.model)];
    const auto& f = measured[static_cast<std::size_t>(pair.measured)].frequency_hz;
    one.mode = pair.model;
    one.relative_error = mode.frequency_hz.value / f.value - 1;
    const double std = std::isfinite(f.std) ? f.std : 0;
    one.standard_units =
        (mode.frequency_hz.value - f.value) / std::hypot(mode.frequency_hz.std, std);
    // The measured value's own uncertainty is part of what the interval must hold.
    const double reach = kCoverage * std;
    one.inside = f.value >= std::min(mode.low_hz, mode.frequency_hz.value - reach) &&
                 f.value <= std::max(mode.high_hz, mode.frequency_hz.value + reach);
  }
  return all;
}

}  // namespace rigfit::ident
