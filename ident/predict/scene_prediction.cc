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
#include "model/frfs/frf_synthesis.h"
#include "model/scene/parameters.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

// Accuracy of frequencies that are compared: a hundredth of a std of 1e-4.
constexpr double kCompared = 1e-6;

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

/// Changes of quantities by the parameters' uncertainty: see the header.
struct Spread {
  Eigen::ArrayXd std, below, above;
};

/// `evaluate`: the quantities of a scene; empty where it has none, which the other side then
/// stands for; not known (NaN) where neither side has them.
template <class Evaluate>
Spread spread_of(const model::Scene& scene, const Selection& selection, const Evaluate& evaluate) {
  const Eigen::ArrayXd here = evaluate(selection.scene(scene, selection.value));
  Spread spread;
  spread.std = spread.below = spread.above = Eigen::ArrayXd::Zero(here.size());
  const Eigen::MatrixXd directions = directions_of(selection.covariance);
  const double factor = coverage_factor(0.95, 0);
  for (Eigen::Index k = 0; k < directions.cols(); ++k) {
    if (!(directions.col(k).norm() > 0)) continue;
    const Eigen::VectorXd step = factor * directions.col(k);
    Eigen::ArrayXd up = evaluate(moved(scene, selection, step)),
                   down = evaluate(moved(scene, selection, -step));
    const bool above = up.size() == here.size(), below = down.size() == here.size();
    if (!above && !below) {
      spread.std = spread.below = spread.above =
          Eigen::ArrayXd::Constant(here.size(), signal::kNaN);
      return spread;
    }
    if (!above) up = 2 * here - down;
    if (!below) down = 2 * here - up;
    spread.std += ((up - down) / (2 * factor)).square();
    spread.below += (here - up.min(down)).max(0).square();
    spread.above += (up.max(down) - here).max(0).square();
  }
  for (auto* part : {&spread.std, &spread.below, &spread.above}) *part = part->sqrt();
  return spread;
}

/// ln of the frequencies of the modes of these planes, in their order, then the damping ratios;
/// empty where one is not there.
Eigen::ArrayXd modes_of(const model::Scene& scene, const std::vector<model::NaturalMode>& wanted,
                        const model::ModesOptions& options) {
  std::map<model::ModePlane, std::vector<const model::NaturalMode*>> found;
  const auto analysis = model::analyse_modes(scene, options);
  for (const auto& mode : analysis.modes) found[mode.plane].push_back(&mode);
  const auto count = static_cast<Eigen::Index>(wanted.size());
  Eigen::ArrayXd values(2 * count);
  std::map<model::ModePlane, std::size_t> seen;
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto plane = wanted[static_cast<std::size_t>(i)].plane;
    const std::size_t order = seen[plane]++;
    if (order >= found[plane].size()) return {};
    values[i] = std::log(found[plane][order]->frequency_hz);
    values[count + i] = found[plane][order]->damping_ratio;
  }
  return values;
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
  model::ModesOptions modes;
  modes.count = options.count;
  modes.segments = options.segments;
  modes.error_estimate = false;
  const auto found = model::analyse_modes(prediction.scene, modes);
  prediction.equilibrium = found.equilibrium;
  if (found.modes.empty()) return prediction;
  modes.shapes = false;
  modes.count = options.count + 2;  // those that cross the last
  if (std::all_of(scene.members.begin(), scene.members.end(), [&](const auto& member) {
        return options.segments.value_or(member.segments) <= 0;
      })) {
    modes.accuracy = kCompared;
  }
  const auto spread = spread_of(
      scene, selection, [&](const model::Scene& at) { return modes_of(at, found.modes, modes); });
  for (std::size_t i = 0; i < found.modes.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const auto& mode = found.modes[i];
    const double f = mode.frequency_hz;
    prediction.modes.push_back(
        {mode,
         {f, f * spread.std[k]},
         {mode.damping_ratio, spread.std[k + static_cast<Eigen::Index>(found.modes.size())]},
         f * std::exp(-spread.below[k]),
         f * std::exp(spread.above[k])});
  }
  return prediction;
}

FrfPrediction predict_frfs(const model::Scene& scene, const FittedParameters& fitted,
                           const Eigen::VectorXd& frequency_hz) {
  const auto selection = select(scene, fitted);
  FrfPrediction prediction;
  prediction.frequency_hz = frequency_hz;
  prediction.H = model::synthesize_frfs(selection.scene(scene, selection.value), frequency_hz).H;
  const auto spread = spread_of(scene, selection, [&](const model::Scene& at) {
    const auto frfs = model::synthesize_frfs(at, frequency_hz);
    std::vector<double> logs;
    for (const auto& H : frfs.H) {
      for (const auto& h : H.reshaped()) logs.push_back(std::log(std::max(std::abs(h), 1e-300)));
    }
    return Eigen::ArrayXd(
        Eigen::Map<const Eigen::ArrayXd>(logs.data(), static_cast<Eigen::Index>(logs.size())));
  });
  Eigen::Index next = 0;
  for (const auto& H : prediction.H) {
    const Eigen::ArrayXXd size = H.cwiseAbs();
    const auto of_line = [&](const Eigen::ArrayXd& all) {
      return all.segment(next, H.size()).reshaped(H.rows(), H.cols()).exp();
    };
    prediction.low.push_back(size / of_line(spread.below));
    prediction.high.push_back(size * of_line(spread.above));
    next += H.size();
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
    const double reach = coverage_factor(0.95, 0) * std;
    one.inside = f.value >= std::min(mode.low_hz, mode.frequency_hz.value - reach) &&
                 f.value <= std::max(mode.high_hz, mode.frequency_hz.value + reach);
  }
  return all;
}

}  // namespace rigfit::ident
