#include "ident/tension/cable_tension.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "ident/tension/tension_formulas.h"
#include "model/linear/modal_analysis.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::Estimate;
using signal::kNaN;

constexpr double kAssumedStrain =
    1e-3;  // of a steel cable at a third of its strength, where no EA is given
constexpr double kSteep =
    0.0872;  // cos of the inclination from which a scene's tension is along the chord

double radians(double degrees) { return degrees * signal::kTwoPi / 360; }

/// The scene's tension (horizontal, or along a steep chord) over the axial force at mid-span.
double scene_share(const CableDescription& cable) {
  const double level = std::cos(radians(cable.inclination_deg));
  return level > kSteep ? level : 1;
}

void check(const CableDescription& cable, const std::vector<MeasuredMode>& modes) {
  const auto positive = [](double value, const char* what) {
    if (!(value > 0) || !std::isfinite(value))
      throw std::invalid_argument(std::string(what) + " must be positive");
  };
  positive(cable.length_m.value, "the length");
  positive(cable.mass_per_length.value, "the mass per length");
  if (cable.EI_Nm2 && !(cable.EI_Nm2->value >= 0))
    throw std::invalid_argument("EI must not be negative");
  if (cable.EA_N) positive(cable.EA_N->value, "EA");
  if (!(std::abs(cable.inclination_deg) <= 90))
    throw std::invalid_argument("the inclination is within +-90 degrees");
  if (modes.empty()) throw std::invalid_argument("no measured frequency");
  for (const auto& mode : modes) positive(mode.frequency_hz.value, "a measured frequency");
}

/// By the lowest frequency as that of a string: where the search begins.
double first_guess(const CableDescription& cable, const std::vector<MeasuredMode>& modes) {
  const auto lowest = std::min_element(
      modes.begin(), modes.end(),
      [](const auto& a, const auto& b) { return a.frequency_hz.value < b.frequency_hz.value; });
  return string_tension(
      {1, lowest->frequency_hz.value, cable.length_m.value, cable.mass_per_length.value, 0});
}

double axial_rigidity(const CableDescription& cable, double tension_N) {
  return cable.EA_N ? cable.EA_N->value : tension_N / kAssumedStrain;
}

/// Whether the modes can tell EI from the tension: three or more.
bool EI_is_fitted(const CableDescription& cable, const std::vector<MeasuredMode>& modes) {
  return cable.EI_Nm2 ? cable.EI_Nm2->std > 0 : modes.size() >= 3;
}

std::vector<FreeParameter> free_parameters(const CableDescription& cable,
                                           const std::vector<MeasuredMode>& modes, CableEnds ends,
                                           double EI) {
  std::vector<FreeParameter> free(1);
  free[0].name = "cable.tension";
  if (EI_is_fitted(cable, modes)) {
    FreeParameter rigidity;
    rigidity.name = "cable.EI";
    if (cable.EI_Nm2) rigidity.prior = cable.EI_Nm2;
    free.push_back(rigidity);
  }
  if (ends == CableEnds::springs) {
    FreeParameter spring;
    spring.name = "spring";
    for (const char* node : {"start", "end"}) {
      for (const char* axis : {"x", "y", "z"})
        spring.targets.push_back(fmt::format("{}.rotational_{}", node, axis));
    }
    spring.low = 0.01 * EI / cable.length_m.value;
    spring.high = 1e4 * EI / cable.length_m.value;
    free.push_back(spring);
  }
  return free;
}

std::vector<UncertainInput> uncertain_inputs(const CableDescription& cable, double EA) {
  std::vector<UncertainInput> inputs;
  const double angle = radians(cable.inclination_deg);
  if (cable.length_m.std > 0) {
    UncertainInput length{"length", {{0, "end.x", cable.length_m.std * std::cos(angle)}}};
    if (cable.inclination_deg != 0)
      length.effects.push_back({0, "end.y", cable.length_m.std * std::sin(angle)});
    inputs.push_back(std::move(length));
  }
  if (cable.mass_per_length.std > 0) {
    inputs.push_back(
        {"mass per length", {{0, "cable.mass_per_length", cable.mass_per_length.std}}});
  }
  const double EA_std = cable.EA_N ? cable.EA_N->std : EA / 2;
  if (EA_std > 0) inputs.push_back({cable.EA_N ? "EA" : "EA (assumed)", {{0, "cable.EA", EA_std}}});
  return inputs;
}

/// Order of each measured mode among those of its plane, and how well it agrees.
void list_modes(const std::vector<MeasuredMode>& modes, TensionCandidate& candidate) {
  candidate.modes.resize(modes.size());
  for (std::size_t i = 0; i < modes.size(); ++i) {
    candidate.modes[i].measured_hz = modes[i].frequency_hz.value;
    candidate.modes[i].model_hz = candidate.modes[i].relative_error = kNaN;
  }
  for (const auto& pair : candidate.update.pairs) {
    auto& mode = candidate.modes[static_cast<std::size_t>(pair.measured)];
    mode.order = pair.order + 1;
    mode.plane = pair.plane;
    mode.model_hz = pair.model_hz;
    mode.relative_error = pair.relative_error;
  }
  for (const auto& one : candidate.update.unpaired)
    candidate.missed += !one.measured && one.missing;
}

TensionCandidate fit_candidate(const CableDescription& cable,
                               const std::vector<MeasuredMode>& modes, CableEnds ends, double guess,
                               const TensionOptions& options) {
  TensionCandidate candidate;
  candidate.ends = ends;
  candidate.spring_Nm_rad = {kNaN, kNaN};
  const double L = cable.length_m.value;
  // Neither a string nor a beam: L sqrt(T / EI) = 30.
  const double EI = cable.EI_Nm2
                        ? std::max(cable.EI_Nm2->value, 1e-9 * guess * L * L)
                        : (EI_is_fitted(cable, modes) ? guess * L * L / 900 : 1e-9 * guess * L * L);
  UpdateState state{"cable", cable_scene(cable, ends, guess, EI), modes};
  UpdateOptions update = options.update;
  update.inputs = uncertain_inputs(cable, axial_rigidity(cable, guess));
  candidate.update = update_model({state}, free_parameters(cable, modes, ends, EI), update);
  const auto& result = candidate.update;
  candidate.message = result.message;
  candidate.solved = result.status == UpdateStatus::converged && !result.parameters.empty();
  if (!candidate.solved) return candidate;
  const double share = scene_share(cable);
  const auto& tension = result.parameters[0];
  candidate.tension_N = {tension.value / share, tension.std / share};
  candidate.low = tension.low / share;
  candidate.high = tension.high / share;
  candidate.EI_Nm2 = {EI, 0};
  for (const auto& parameter : result.parameters) {
    if (parameter.name == "cable.EI") candidate.EI_Nm2 = {parameter.value, parameter.std};
    if (parameter.name == "spring") candidate.spring_Nm_rad = {parameter.value, parameter.std};
  }
  candidate.fit = result.fit;
  candidate.budget = tension.budget;
  for (auto& term : candidate.budget) term.std /= share;
  list_modes(modes, candidate);
  return candidate;
}

void weigh(std::vector<TensionCandidate>& candidates) {
  double best = -std::numeric_limits<double>::infinity(), sum = 0;
  for (const auto& one : candidates) {
    if (one.solved && std::isfinite(one.update.log_evidence))
      best = std::max(best, one.update.log_evidence);
  }
  for (auto& one : candidates) {
    one.weight = one.solved && std::isfinite(one.update.log_evidence)
                     ? std::exp(one.update.log_evidence - best)
                     : 0;
    sum += one.weight;
  }
  for (auto& one : candidates) one.weight = sum > 0 ? one.weight / sum : 0;
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.weight > b.weight; });
}

/// Distribution function of the mixture: each answer normal in ln T.
double mixture_below(const std::vector<TensionCandidate>& candidates, double tension) {
  double below = 0;
  for (const auto& one : candidates) {
    if (!(one.weight > 0)) continue;
    const double s = (std::log(one.high) - std::log(one.low)) / (2 * 1.959964);
    const double middle = (std::log(one.high) + std::log(one.low)) / 2;
    below += one.weight * 0.5 * std::erfc((middle - std::log(tension)) / (s * std::sqrt(2.0)));
  }
  return below;
}

double mixture_quantile(const std::vector<TensionCandidate>& candidates, double probability) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const auto& one : candidates) {
    if (!(one.weight > 0)) continue;
    low = std::min(low, one.low * one.low / one.high);
    high = std::max(high, one.high * one.high / one.low);
  }
  for (int i = 0; i < 100; ++i) {
    const double middle = std::sqrt(low * high);
    (mixture_below(candidates, middle) < probability ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

/// Weight of all answers that give the measured modes the orders that the heaviest one gives them.
double weight_of_orders(const std::vector<TensionCandidate>& candidates) {
  const auto& best = candidates.front().modes;
  double weight = 0;
  for (const auto& one : candidates) {
    const bool same = one.weight > 0 &&
                      std::equal(best.begin(), best.end(), one.modes.begin(), one.modes.end(),
                                 [](const auto& a, const auto& b) { return a.order == b.order; });
    if (!same) continue;
    const auto& alternatives = one.update.alternatives;
    weight += one.weight * (alternatives.empty() ? 1 : alternatives.front().weight);
  }
  return weight;
}

/// Mean, spread and interval over the candidates.
void mix(TensionResult& result) {
  double mean = 0, square = 0, within = 0;
  bool bounded = true;
  for (const auto& one : result.candidates) {
    if (!(one.weight > 0)) continue;
    mean += one.weight * one.tension_N.value;
    within += one.weight * one.tension_N.std * one.tension_N.std;
    square += one.weight * one.tension_N.value * one.tension_N.value;
    bounded = bounded && one.low > 0 && std::isfinite(one.high);
  }
  const auto& best = result.candidates.front();
  const double between = std::max(0.0, square - mean * mean);
  const bool one_only = best.weight > 0.999;
  result.tension_N = one_only ? best.tension_N : Estimate{mean, std::sqrt(within + between)};
  result.EI_Nm2 = best.EI_Nm2;
  result.budget = best.budget;
  if (!one_only) result.budget.push_back({"ends", std::sqrt(between)});
  result.low = one_only ? best.low : bounded ? mixture_quantile(result.candidates, 0.025) : kNaN;
  result.high = one_only ? best.high : bounded ? mixture_quantile(result.candidates, 0.975) : kNaN;
  result.decided = weight_of_orders(result.candidates) >= 0.9;
}

/// What follows from the tension: its course along the cable, sag, dimensionless numbers, formulas.
void describe(const CableDescription& cable, TensionResult& result) {
  const auto& best = result.candidates.front();
  const double L = cable.length_m.value, T = result.tension_N.value,
               angle = radians(cable.inclination_deg);
  const double weight = cable.mass_per_length.value * cable.gravity, EA = axial_rigidity(cable, T);
  const double across = weight * std::cos(angle);
  result.sag_m = across * L * L / (8 * T);
  const double rise = L * std::sin(angle), middle = rise / 2 - result.sag_m * std::cos(angle);
  result.start_N = T - weight * middle;
  result.end_N = T + weight * (rise - middle);
  const double stretched = L * (1 + std::pow(across * L / T, 2) / 8);
  result.irvine_parameter = std::pow(across * L / T, 2) * L * EA / (T * stretched);
  result.bending_parameter = L * std::sqrt(T / best.EI_Nm2.value);
  const TensionMode* lowest = nullptr;
  for (const auto& mode : best.modes) {
    if (mode.order > 0 && (lowest == nullptr || mode.measured_hz < lowest->measured_hz))
      lowest = &mode;
  }
  if (lowest == nullptr) return;
  const CableFormulaInput input{lowest->order, lowest->measured_hz, L, cable.mass_per_length.value,
                                best.EI_Nm2.value};
  result.formulas = {string_tension(input), pinned_beam_tension(input), clamped_beam_tension(input),
                     zui_tension(input)};
}

}  // namespace

const char* name_of(CableEnds ends) {
  switch (ends) {
    case CableEnds::pinned:
      return "pinned";
    case CableEnds::clamped:
      return "clamped";
    case CableEnds::springs:
      return "springs";
  }
  return "";
}

model::Scene cable_scene(const CableDescription& cable, CableEnds ends, double tension_N,
                         double EI_Nm2) {
  model::Scene scene;
  scene.title = std::string("cable, ") + name_of(ends) + " ends";
  scene.gravity = {0, -cable.gravity, 0};
  const double angle = radians(cable.inclination_deg), L = cable.length_m.value;
  scene.nodes.resize(2);
  scene.nodes[0].name = "start";
  scene.nodes[1].name = "end";
  scene.nodes[1].position = {L * std::cos(angle), L * std::sin(angle), 0};
  for (auto& node : scene.nodes) {
    if (ends == CableEnds::pinned) node.support.kind = model::Support::Kind::pinned;
    if (ends == CableEnds::clamped) node.support.kind = model::Support::Kind::clamped;
    if (ends == CableEnds::springs) {
      node.support.kind = model::Support::Kind::elastic;
      node.support.translational.setConstant(std::numeric_limits<double>::infinity());
      node.support.rotational.setConstant(10 * EI_Nm2 / L);
    }
  }
  model::Member member;
  member.name = "cable";
  member.nodes = {"start", "end"};
  const double EA = axial_rigidity(cable, tension_N);
  const bool installed = cable.mass_reference == MassReference::installed;
  member.mass_per_length = cable.mass_per_length.value * (installed ? 1 + tension_N / EA : 1);
  member.EA = EA;
  member.EI = {EI_Nm2, EI_Nm2};
  member.GJ = EI_Nm2;
  member.tension = tension_N * scene_share(cable);
  member.masses = cable.masses;
  scene.members.push_back(member);
  return scene;
}

std::vector<MeasuredMode> merged_modes(std::vector<MeasuredMode> modes) {
  std::stable_sort(modes.begin(), modes.end(), [](const auto& a, const auto& b) {
    return a.frequency_hz.value < b.frequency_hz.value;
  });
  std::vector<MeasuredMode> merged;
  for (std::size_t first = 0; first < modes.size();) {
    std::size_t end = first;
    double weights = 0, sum = 0, chi2 = 0;
    for (; end < modes.size(); ++end) {
      const auto& f = modes[end].frequency_hz;
      if (end > first) {
        const double apart = f.value - sum / weights;
        if (modes[end].plane != modes[first].plane ||
            !(std::abs(apart) < 3 * std::sqrt(f.std * f.std + 1 / weights))) {
          break;
        }
        chi2 += apart * apart / (f.std * f.std + 1 / weights);
      }
      weights += 1 / (f.std * f.std);
      sum += f.value / (f.std * f.std);
    }
    merged.push_back(modes[first]);
    if (end > first + 1) {
      const double excess = std::max(1.0, chi2 / static_cast<double>(end - first - 1));
      merged.back().frequency_hz = {sum / weights, std::sqrt(excess / weights)};
    }
    first = end;
  }
  return merged;
}

TensionResult identify_tension(const CableDescription& cable,
                               const std::vector<MeasuredMode>& modes,
                               const TensionOptions& options) {
  check(cable, modes);
  TensionResult result;
  result.EA_assumed = !cable.EA_N;
  result.EI_neglected = !cable.EI_Nm2 && !EI_is_fitted(cable, modes);
  double guess = first_guess(cable, modes);
  for (const CableEnds ends : options.ends) {
    auto candidate = fit_candidate(cable, modes, ends, guess, options);
    // Once more from its own tension: EA and the mass go with it where they follow from a strain.
    const bool follows = !cable.EA_N || cable.mass_reference == MassReference::installed;
    if (candidate.solved && follows &&
        std::abs(std::log(candidate.tension_N.value / guess)) > 0.01) {
      candidate = fit_candidate(cable, modes, ends, candidate.tension_N.value, options);
    }
    result.candidates.push_back(std::move(candidate));
  }
  weigh(result.candidates);
  const auto& best = result.candidates.front();
  if (!(best.weight > 0)) {
    result.message = best.message.empty() ? "no tension fits the frequencies" : best.message;
    return result;
  }
  result.solved = true;
  mix(result);
  describe(cable, result);
  const double strain = result.tension_N.value / axial_rigidity(cable, result.tension_N.value);
  result.mass_reference_matters =
      !cable.mass_reference && strain * result.tension_N.value > result.tension_N.std / 3;
  return result;
}

}  // namespace rigfit::ident
