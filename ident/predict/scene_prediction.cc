#include "ident/predict/scene_prediction.h"

#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>

#include "ident/update/pairing/mode_assignment.h"
#include "model/scene/parameters.h"
#include "signal/recording/add_note.h"

namespace rigfit::ident {
namespace {

/// The targets of a parameter that a scene has, each with the factor from the value to it.
using Targets = std::vector<std::pair<std::string, double>>;

Targets targets_in(const model::Scene& scene, const KnownParameter& parameter) {
  const auto names = model::parameter_names(scene);
  const auto has = [&](const auto& name) { return std::ranges::count(names, name) > 0; };
  Targets found;
  for (std::size_t i = 0; i < parameter.targets.size(); ++i) {
    const auto& target = parameter.targets[i];
    if (target.empty()) return {};
    if (!has(target)) {
      throw std::invalid_argument(fmt::format("{} cannot be \"{}\" here: use one of {}",
                                              parameter.name, target, fmt::join(names, ", ")));
    }
    found.emplace_back(target, i < parameter.factors.size() ? parameter.factors[i] : 1);
  }
  if (!found.empty()) return found;
  std::string name = parameter.name;
  if (!has(name) && name.ends_with(".EI_z")) name.resize(name.size() - 2);
  if (!has(name) && name.ends_with(".EI")) name += "_z";
  if (has(name)) found.emplace_back(name, 1);
  return found;
}

/// The parameters that a scene has, with the targets that each moves.
struct Selection {
  std::vector<Targets> targets;
  VectorXd value;
  MatrixXd covariance;
  std::vector<std::string> used, not_used;

  [[nodiscard]] model::Scene scene(model::Scene base, const VectorXd& values) const {
    for (Index p = 0; p < values.size(); ++p) {
      for (const auto& [target, factor] : targets[static_cast<std::size_t>(p)]) {
        model::set_parameter(base, target, factor * values[p]);
      }
    }
    return base;
  }
};

Selection select(const model::Scene& scene, const FittedParameters& fitted) {
  Selection selection;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < fitted.parameters.size(); ++i) {
    const auto& parameter = fitted.parameters[i];
    auto targets = targets_in(scene, parameter);
    (targets.empty() ? selection.not_used : selection.used).push_back(parameter.name);
    if (targets.empty()) continue;
    selection.targets.push_back(std::move(targets));
    kept.push_back(i);
  }
  if (kept.empty()) {
    throw std::invalid_argument(fmt::format(
        "no parameter of the fit is one of this scene's: the fit has \"{}\"; the scene "
        "has \"{}\"",
        fmt::join(selection.not_used, "\" \""), fmt::join(model::parameter_names(scene), "\" \"")));
  }
  selection.value = VectorXd::NullaryExpr(std::ssize(kept), [&](Index i) {
    return fitted.parameters[kept[static_cast<std::size_t>(i)]].value;
  });
  selection.covariance = fitted.covariance(kept, kept);
  return selection;
}

/// `base` with the parameters moved; those that are positive stay so.
model::Scene moved(const model::Scene& base, const Selection& selection, const VectorXd& change) {
  VectorXd values = selection.value;
  for (Index i = 0; i < values.size(); ++i) {
    values[i] = values[i] > 0 ? values[i] * std::exp(change[i] / values[i]) : values[i] + change[i];
  }
  return selection.scene(base, values);
}

/// Changes of quantities by the parameters' uncertainty: see the header.
struct Spread {
  ArrayXd std, below, above;
};

/// `evaluate`: the quantities of a scene; empty where it has none, which the other side then
/// stands for; not known (NaN) where neither side has them.
template <class Evaluate>
Spread spread_of(const model::Scene& scene, const Selection& selection, const Evaluate& evaluate) {
  const ArrayXd here = evaluate(selection.scene(scene, selection.value));
  Spread spread;
  spread.std = spread.below = spread.above = ArrayXd::Zero(here.size());
  // Independent moves of one standard uncertainty each, as columns.
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(selection.covariance);
  const MatrixXd directions =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  const double factor = coverage_factor(0.95, 0);
  for (Index k = 0; k < directions.cols(); ++k) {
    if (!(directions.col(k).norm() > 0)) continue;
    const VectorXd step = factor * directions.col(k);
    ArrayXd up = evaluate(moved(scene, selection, step)),
            down = evaluate(moved(scene, selection, -step));
    const bool above = up.size() == here.size(), below = down.size() == here.size();
    if (!above && !below) {
      spread.std = spread.below = spread.above = ArrayXd::Constant(here.size(), kNaN);
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
ArrayXd modes_of(const model::Scene& scene, const std::vector<model::NaturalMode>& wanted,
                 const model::ModesOptions& options) {
  const auto found = model::analyse_modes(scene, options).modes;
  const auto count = static_cast<Index>(wanted.size());
  ArrayXd values(2 * count);
  std::map<model::ModePlane, std::size_t> next;
  for (Index i = 0; i < count; ++i) {
    const auto plane = wanted[static_cast<std::size_t>(i)].plane;
    auto& at = next[plane];
    while (at < found.size() && found[at].plane != plane) ++at;
    if (at == found.size()) return {};
    values[i] = std::log(found[at].frequency_hz);
    values[count + i] = found[at++].damping_ratio;
  }
  return values;
}

}  // namespace

void add_effect(const std::string& input, Index parameter, double change,
                FittedParameters& fitted) {
  const auto size = static_cast<Index>(fitted.parameters.size());
  fitted.inputs.try_emplace(input, VectorXd::Zero(size)).first->second[parameter] = change;
}

std::vector<SceneInput> add_scene_inputs(const model::Scene& scene, std::vector<SceneInput> inputs,
                                         FittedParameters& fitted) {
  const auto of_fit = static_cast<Index>(fitted.parameters.size());
  for (auto& one : inputs) {
    const double value = one.value.value_or(model::parameter(scene, one.name));
    one.value = value;
    if (one.relative) one.std *= std::abs(value), one.relative = false;
    if (!(one.std > 0) || !std::isfinite(one.std) || !std::isfinite(value)) {
      throw std::invalid_argument("the uncertainty of " + one.name + " is not positive");
    }
    if (std::ranges::count(inputs, one.name, &SceneInput::name) > 1) {
      throw std::invalid_argument("the uncertainty of " + one.name + " is given twice");
    }
    one.fitted = std::ranges::any_of(fitted.parameters, [&](const auto& parameter) {
      const auto targets = targets_in(scene, parameter);
      return std::ranges::count(targets, one.name, &Targets::value_type::first) > 0;
    });
    if (one.fitted) continue;
    const auto n = static_cast<Index>(fitted.parameters.size());
    fitted.parameters.push_back({one.name, value});
    fitted.covariance.conservativeResizeLike(MatrixXd::Zero(n + 1, n + 1));
    fitted.covariance(n, n) = one.std * one.std;
    const auto effect = fitted.inputs.find(one.name);
    one.of_fit = effect != fitted.inputs.end();
    if (!one.of_fit) continue;
    fitted.covariance.col(n).head(of_fit) = one.std * effect->second.head(of_fit);
    fitted.covariance.row(n) = fitted.covariance.col(n).transpose();
  }
  return inputs;
}

std::vector<Finding> replaced_states(const model::Scene& scene, const FittedParameters& fitted) {
  constexpr std::array kStates{"tension", "stretch", "unstretched_length", "temperature_change"};
  std::vector<Finding> findings;
  for (Index p = 0; p < std::ssize(fitted.parameters); ++p) {
    const auto& parameter = fitted.parameters[static_cast<std::size_t>(p)];
    for (const auto& [target, factor] : targets_in(scene, parameter)) {
      if (std::ranges::count(kStates, target.substr(target.rfind('.') + 1)) == 0) continue;
      const double own = model::parameter(scene, target), value = factor * parameter.value,
                   std = std::abs(factor) * std::sqrt(fitted.covariance(p, p));
      if (std::abs(value - own) <= coverage_factor(0.95, 0) * std) continue;
      signal::add_note(findings, "input_is_fitted", scene.file,
                       "Give --map {}= to keep the scene's {} of {:.6g}: the fit's {:.6g} +- "
                       "{:.2g} replaces it",
                       parameter.name, target, own, value, std);
    }
  }
  return findings;
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
    modes.accuracy = kComparedAccuracy;
  }
  const auto spread = spread_of(
      scene, selection, [&](const model::Scene& at) { return modes_of(at, found.modes, modes); });
  for (std::size_t i = 0; i < found.modes.size(); ++i) {
    const auto k = static_cast<Index>(i);
    const auto& mode = found.modes[i];
    const double f = mode.frequency_hz;
    prediction.modes.push_back(
        {mode,
         {{f, f * spread.std[k]}, {f * std::exp(-spread.below[k]), f * std::exp(spread.above[k])}},
         {mode.damping_ratio, spread.std[k + static_cast<Index>(found.modes.size())]}});
  }
  return prediction;
}

std::vector<HeldAgainst> held_against(const ModePrediction& prediction,
                                      const std::vector<MeasuredMode>& measured) {
  std::vector<PairingMode> tested, modelled;
  for (const auto& mode : measured) tested.push_back({mode.frequency_hz.value, mode.plane});
  for (const auto& mode : prediction.modes) {
    modelled.push_back({mode.frequency_hz.value, mode.mode.plane});
  }
  std::vector<HeldAgainst> all(measured.size());
  for (std::size_t i = 0; i < measured.size(); ++i) all[i].measured_hz = measured[i].frequency_hz;
  for (const auto& pair : pair_modes(tested, modelled)) {
    auto& one = all[static_cast<std::size_t>(pair.measured)];
    const auto& mode = prediction.modes[static_cast<std::size_t>(pair.model)];
    const auto& f = one.measured_hz;
    one.mode = pair.model;
    one.predicted_hz = mode.frequency_hz;
    one.relative_error = mode.frequency_hz.value / f.value - 1;
    const double std = std::isfinite(f.std) ? f.std : 0;
    // The measured value's own uncertainty is part of what the interval must hold.
    const double reach = coverage_factor(0.95, 0) * std;
    one.inside = f.value >= std::min(mode.frequency_hz.low, mode.frequency_hz.value - reach) &&
                 f.value <= std::max(mode.frequency_hz.high, mode.frequency_hz.value + reach);
  }
  return all;
}

}  // namespace rigfit::ident
