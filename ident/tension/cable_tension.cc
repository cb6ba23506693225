#include "ident/tension/cable_tension.h"

#include <fmt/ranges.h>
#include <gsl/gsl_cdf.h>

#include <Eigen/LU>

#include "ident/update/model_candidates.h"
#include "signal/estimation/groups.h"

namespace rigfit::ident {

namespace {

// Strain at the tension that is assumed where no EA is given (a steel cable at a third of its
// strength), and the std of its logarithm: within a factor of 2 or so.
constexpr double kAssumedStrain = 1e-3, kAssumedStrainStd = 0.5;
constexpr double kChanceRuledOut = 1e-6;  // below it what was measured is no such cable
constexpr double kSoundModel = 5e-3;      // error of the model that the chance counts, at most
// L sqrt(T / EI) of cables without EI: hardly more than beams to strings.
constexpr double kStiffest = 2, kSlackest = 2000;

double angle_of(const CableDescription& cable) { return cable.inclination_deg * kTwoPi / 360; }

/// EA as given or assumed, at a tension.
double axial_rigidity(const CableDescription& cable, double tension_N) {
  return cable.EA_N ? cable.EA_N->value : tension_N / kAssumedStrain;
}

/// Weight per length across the chord, N/m.
double weight_across(const CableDescription& cable) {
  return cable.mass_per_length.value * cable.gravity * std::cos(angle_of(cable));
}

/// Irvine's parameter (w L / T)^2 EA L / (T Le), w the weight per length across the chord and
/// Le = L (1 + (w L / T)^2 / 8). Source: T. M. Irvine, Cable Structures, 1981, ch. 3.
double irvine_parameter(const CableDescription& cable, double tension_N) {
  const double slope = weight_across(cable) * cable.length_m.value / tension_N;
  return slope * slope * axial_rigidity(cable, tension_N) / (tension_N * (1 + slope * slope / 8));
}

/// What is flat in its logarithm over a range, as a normal density of that mean and std.
Estimate flat_prior(double low, double high) {
  const double centre = std::sqrt(low * high);
  return {centre, centre * std::log(high / low) / std::sqrt(12.0)};
}

/// The cable about a tension: all that is not known, as parameters and inputs of scenes.
struct CableProblem {
  std::vector<ModelCandidate> candidates;
  UpdateOptions options;
};

/// Where a search begins: a pinned beam's (f / n)^2 = (T + EI (n pi / L)^2) / (4 m L^2), a line
/// over n^2. With every second mode of a stiff beam a soft one of a quarter of the tension agrees.
struct PinnedBeam {
  double tension_N;
  std::optional<double> EI_Nm2 = {};  ///< none where the frequencies are no such line's
};

PinnedBeam pinned_beam(const CableDescription& cable, const std::vector<MeasuredMode>& modes) {
  Eigen::Matrix2d gram = Eigen::Matrix2d::Zero();
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double lowest = modes.front().frequency_hz.value;
  for (const auto& mode : modes) {
    const double f = mode.frequency_hz.value;
    lowest = std::min(lowest, f);
    const auto below = std::count_if(modes.begin(), modes.end(), [&](const auto& other) {
      return other.plane == mode.plane && other.frequency_hz.value < f;
    });
    const double n = mode.order > 0 ? mode.order : static_cast<double>(below) + 1;
    const Eigen::Vector2d row = Eigen::Vector2d(1, n * n) * (n * n / (f * f));  // relative errors
    gram += row * row.transpose(), sum += row;
  }
  const double L = cable.length_m.value, scale = 4 * cable.mass_per_length.value * L * L;
  const Eigen::Vector2d line = gram.inverse() * sum;
  // Modes of one order are no line (0 but for rounding; of orders 58 to 60 it is 8e-4 of the
  // product).
  const bool orders_differ = gram.determinant() > 1e-6 * gram(0, 0) * gram(1, 1);
  if (modes.size() < 3 || !orders_differ || !(line.minCoeff() > 0)) {
    return {scale * lowest * lowest};
  }
  return {scale * line(0), scale * line(1) * std::pow(L / std::numbers::pi, 2)};
}

CableProblem problem_of(const CableDescription& cable, const std::vector<MeasuredMode>& modes,
                        const TensionOptions& asked, const PinnedBeam& start) {
  const double tension_N = start.tension_N;
  // Inputs are linear and normal in their value, and zero must stay five standard uncertainties
  // away; what is known to less is normal in its logarithm.
  constexpr double kLinear = 0.2;
  const double L = cable.length_m.value, stiffest = tension_N * L * L;
  const Estimate flexible{1e-8 * stiffest, 0};  // no frequency tells it from EI = 0
  Estimate EI = cable.EI_Nm2 ? *cable.EI_Nm2
                             : flat_prior(stiffest / std::pow(kSlackest, 2),
                                          stiffest / std::pow(kStiffest, 2));
  if (EI.value < flexible.value) EI = flexible;
  const double EA_value = axial_rigidity(cable, tension_N);
  const Estimate EA = cable.EA_N ? *cable.EA_N : Estimate{EA_value, kAssumedStrainStd * EA_value};
  CableProblem problem;
  auto& inputs = problem.options.inputs;
  std::vector<FreeParameter> free{{.name = "cable.tension"}};
  const auto known_to = [&](const std::string& name, std::vector<std::string> targets,
                            const Estimate& value) {
    if (!(value.std > 0)) return;
    if (value.std > kLinear * value.value) {
      free.push_back({.name = name, .targets = std::move(targets), .prior = value});
      if (name == "EI") free.back().start = start.EI_Nm2;
      return;
    }
    inputs.push_back({name, {}});
    for (auto& target : targets) inputs.back().effects.push_back({0, target, value.std});
  };
  known_to("EI", {"cable.EI_z", "cable.EI_y", "cable.GJ"}, EI);  // curved, bending twists
  // The first symmetric frequency rises by 4 / pi^4 of Irvine's parameter, here 4e-5: less is taut.
  if (irvine_parameter(cable, tension_N) > 1e-3) {
    known_to(cable.EA_N ? "EA" : "EA (assumed)", {"cable.EA"}, EA);
  }
  known_to("mass per length", {"cable.mass_per_length"}, cable.mass_per_length);
  if (cable.length_m.std > 0) {
    const double angle = angle_of(cable);
    inputs.push_back({"length",
                      {{0, "end.x", cable.length_m.std * std::cos(angle)},
                       {0, "end.y", cable.length_m.std * std::sin(angle)}}});
  }
  if (!cable.masses.empty() && cable.masses_std > 0) {
    inputs.push_back({"attached masses", {}});
    for (std::size_t k = 0; k < cable.masses.size(); ++k) {
      inputs.back().effects.push_back(
          {0, fmt::format("cable.masses{}.mass", k + 1), cable.masses_std * cable.masses[k].mass});
    }
  }
  problem.options.profiled = 1;  // the tension
  problem.options.assignment = asked.assignment;
  for (const CableEnds ends : asked.ends) {
    ModelCandidate one{name_of(ends), std::vector<UpdateState>(1), free};
    one.states.front().scene = cable_scene(cable, ends, tension_N, EI.value);
    one.states.front().measured = modes;
    one.states.front().clock_relative_std = cable.rate_relative_std;
    if (ends == CableEnds::springs) {
      // k = q EI (x + 4) / L, x = L sqrt(T / EI): practically pinned to practically clamped.
      const double likely = cable.EI_Nm2 ? EI.value : start.EI_Nm2.value_or(EI.value);
      const double scale = likely * (std::sqrt(stiffest / likely) + 4) / L;
      one.free.push_back(
          {.name = "end springs",
           .targets = {"start.rotational_z", "start.rotational_y", "start.rotational_x",
                       "end.rotational_z", "end.rotational_y", "end.rotational_x"},
           .prior = flat_prior(0.03 * scale, 30 * scale)});
    }
    problem.candidates.push_back(std::move(one));
  }
  return problem;
}

/// Fits about a beam's tension, then about the tension found: what is assumed goes with it, and
/// half of the least std of an assumed logarithm (EA's) is near enough.
CandidateComparison compare(const CableDescription& cable, const std::vector<MeasuredMode>& modes,
                            const TensionOptions& options) {
  PinnedBeam start = pinned_beam(cable, modes);
  CandidateComparison compared;
  for (int round = 0; round < 3; ++round) {
    const auto problem = problem_of(cable, modes, options, start);
    compared = compare_candidates(problem.candidates, problem.options);
    if (compared.heaviest < 0) break;
    const auto& best = compared.candidates[static_cast<std::size_t>(compared.heaviest)].result;
    const double found = best.parameters.front().value / scene_tension_factor(cable);
    const bool assumed =
        !cable.EI_Nm2 || !cable.EA_N || cable.mass_reference == MassReference::installed;
    if (!assumed || std::abs(std::log(found / start.tension_N)) < kAssumedStrainStd / 2) break;
    start.tension_N = found;
  }
  return compared;
}

/// A parameter in units of N of tension at mid-span.
BoundedEstimate tension_of(const UpdatedParameter& parameter, double factor) {
  return {{parameter.value / factor, parameter.std / factor},
          {parameter.low / factor, parameter.high / factor}};
}

/// Each measured mode with its partner.
void list_modes(const std::vector<MeasuredMode>& modes, const UpdateResult& result,
                TensionCandidate& candidate) {
  for (const auto& mode : modes) {
    candidate.modes.push_back(
        {.measured_hz = mode.frequency_hz.value, .measured_std_hz = mode.frequency_hz.std});
  }
  for (const auto& pair : result.pairs) {
    auto& mode = candidate.modes[static_cast<std::size_t>(pair.measured)];
    mode.order = pair.order + 1;
    mode.plane = pair.plane;
    mode.model_hz = pair.model_hz;
    mode.relative_error = pair.relative_error;
  }
  for (const auto& one : result.unpaired) candidate.missed += one.missing();
}

/// The chance of the paired frequencies' errors with a sound model's error.
double chance_of(const TensionCandidate& candidate) {
  const auto& fit = candidate.fit;
  double weighted = 0;
  for (const auto& mode : candidate.modes) {
    if (mode.order == 0) continue;
    const double own = fit.stated ? mode.measured_std_hz / mode.measured_hz : 0;
    const double of_model = fit.stated ? std::min(fit.model_std, kSoundModel) : fit.model_std;
    weighted += mode.relative_error * mode.relative_error / (own * own + of_model * of_model);
  }
  const bool known = fit.degrees_of_freedom > 0 && weighted > 0 && std::isfinite(weighted);
  return known ? gsl_cdf_chisq_Q(weighted, fit.degrees_of_freedom) : 1;
}

TensionCandidate candidate_of(const CableDescription& cable, const std::vector<MeasuredMode>& modes,
                              const FittedCandidate& fitted) {
  TensionCandidate candidate;
  candidate.ends = cable_ends(fitted.name).front();
  const auto& result = fitted.result;
  if (result.status == UpdateStatus::no_model) {
    candidate.message = "no tension fits the frequencies with these ends: " + result.message;
    return candidate;
  }
  candidate.solved = true;
  candidate.weight = fitted.weight;
  const double factor = scene_tension_factor(cable);
  const auto& tension = result.parameters.front();
  candidate.tension_N = tension_of(tension, factor);
  const auto* EI = find(result.parameters, "EI");
  candidate.EI_Nm2 = EI != nullptr ? Estimate{EI->value, EI->std} : *cable.EI_Nm2;
  if (const auto* spring = find(result.parameters, "end springs")) {
    candidate.spring_Nm_rad = {spring->value, spring->std};
  }
  candidate.fit = result.fit;
  list_modes(modes, result, candidate);
  for (std::size_t i = 0; i < modes.size(); ++i) {
    if (modes[i].order == 0 || candidate.modes[i].order > 0) continue;
    candidate.solved = false;
    candidate.message = fmt::format("no tension gives {:.5g} Hz order {} with these ends",
                                    modes[i].frequency_hz.value, modes[i].order);
  }
  return candidate;
}

/// What the uncertainty of the tension comes from, by the law of total variance: within answers
/// their budgets, between the answers of one kind of ends "assignment", between kinds "ends".
std::vector<TensionBudgetRow> budget_of(const CandidateComparison& compared, double factor) {
  std::map<std::string, double> variance;
  std::map<std::string, std::pair<double, double>> of_ends;  // weight, weighted mean
  const auto& all = compared.averaged.front();
  const double beside = (all.high - all.low) / 2;
  double sum = 0, between = 0;
  for (const auto& candidate : compared.candidates) {
    if (!(candidate.weight > 0)) continue;
    for (const auto& answer : candidate.result.alternatives) {
      const auto& own = answer.parameters.front();
      if (own.value < all.low - beside || own.value > all.high + beside) continue;
      const double weight = candidate.weight * answer.weight;
      auto& [of_kind, mean] = of_ends[candidate.name];
      sum += weight, of_kind += weight, mean += weight * own.value;
      between += weight * std::pow(own.value - all.value, 2);
      for (const auto& term : own.budget) {
        std::string source = term.source == "data" ? "frequencies" : term.source;
        if (source.starts_with("prior of ")) source = source.substr(9);
        variance[source] += weight * term.std * term.std;
      }
    }
  }
  for (const auto& [name, kind] : of_ends) {
    variance["ends"] += kind.first * std::pow(kind.second / kind.first - all.value, 2);
  }
  variance["assignment"] = between - variance["ends"];
  std::vector<TensionBudgetRow> rows;
  for (const auto& [source, part] : variance) {
    // What rounding leaves of a difference of squares is no source.
    if (part / sum > 1e-16 * all.value * all.value) {
      rows.push_back({source, std::sqrt(part / sum) / factor});
    }
  }
  std::ranges::stable_sort(rows, std::greater(), &TensionBudgetRow::std_N);
  return rows;
}

/// Tension over that of a string, from C / f and the string's T L^2 / EI: each formula holds for a
/// range of xi = L sqrt(T / EI), and the one whose tension lies in its range is taken.
double zui_factor(double ratio, double string) {
  const double slender = 1 - 2.20 * ratio - 0.550 * ratio * ratio;
  const double middle = 0.865 - 11.6 * ratio * ratio, stocky = 0.828 - 10.5 * ratio * ratio;
  if (slender > 0 && string * slender >= 17 * 17) return slender;
  if (middle > 0 && string * middle >= 6 * 6 && string * middle < 17 * 17) return middle;
  return stocky > 0 && string * stocky < 6 * 6 ? stocky : kNaN;
}

/// What follows from the tension: its course along the cable, sag, dimensionless numbers, formulas.
void describe(const CableDescription& cable, TensionResult& result) {
  const auto& best = result.candidates.front();
  const double L = cable.length_m.value, T = result.tension_N.value, angle = angle_of(cable);
  const double weight = cable.mass_per_length.value * cable.gravity;
  result.sag_m = weight_across(cable) * L * L / (8 * T);
  const double rise = L * std::sin(angle), middle = rise / 2 - result.sag_m * std::cos(angle);
  result.start_N = T - weight * middle;
  result.end_N = T + weight * (rise - middle);
  result.irvine_parameter = irvine_parameter(cable, T);
  result.bending_parameter = L * std::sqrt(T / best.EI_Nm2.value);
  const auto lowest = std::ranges::find_if(
      best.modes, [](int order) { return order > 0; }, &TensionMode::order);
  if (lowest == best.modes.end()) return;
  // From the lowest mode, with EI: pinned exact, clamped after Zui et al. (1996) for the first
  // mode.
  const double n = lowest->order, f = lowest->measured_hz, m = cable.mass_per_length.value,
               EI = best.EI_Nm2.value;
  auto& formulas = result.formulas;
  formulas.string_N = 4 * m * std::pow(f * L / n, 2);
  formulas.pinned_beam_N = formulas.string_N - std::pow(n * std::numbers::pi / L, 2) * EI;
  if (!(formulas.pinned_beam_N > 0)) formulas.pinned_beam_N = kNaN;
  formulas.zui_N = n == 1 ? formulas.string_N * zui_factor(std::sqrt(EI / m) / (L * L * f),
                                                           formulas.string_N * L * L / EI)
                          : kNaN;
}

/// Weight of the answers in which the measured modes are what they are in the heaviest.
double decided_weight(const CandidateComparison& compared) {
  const auto orders_of = [](const UpdateAlternative& answer) {
    std::vector<std::pair<int, int>> orders;
    for (const auto& pair : answer.pairs) orders.emplace_back(pair.measured, pair.order);
    return orders;
  };
  const auto answers = answers_of(compared);
  const auto heaviest = orders_of(
      compared.candidates[static_cast<std::size_t>(compared.heaviest)].result.alternatives.front());
  double weight = 0;
  for (const auto& answer : answers) weight += orders_of(answer) == heaviest ? answer.weight : 0;
  return weight;
}

}  // namespace

double scene_tension_factor(const CableDescription& cable) {
  constexpr double kSteep = 0.0872;  // cos of 85 degrees, from which a scene's tension is axial
  const double level = std::cos(angle_of(cable));
  return level > kSteep ? level : 1;
}

model::Scene cable_scene(const CableDescription& cable, CableEnds ends, double tension_N,
                         double EI_Nm2) {
  model::Scene scene;
  scene.title = std::string("cable, ") + name_of(ends) + " ends";
  scene.gravity = {0, -cable.gravity, 0};
  const double angle = angle_of(cable), L = cable.length_m.value;
  scene.nodes.resize(2);
  scene.nodes[0].name = "start";
  scene.nodes[1].name = "end";
  scene.nodes[1].position = {L * std::cos(angle), L * std::sin(angle), 0};
  for (auto& node : scene.nodes) {
    const bool pinned = ends == CableEnds::pinned ||
                        (ends == CableEnds::pinned_clamped && &node == &scene.nodes.front());
    node.support.kind = pinned ? model::Support::Kind::pinned : model::Support::Kind::clamped;
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
  member.tension = tension_N * scene_tension_factor(cable);
  member.masses = cable.masses;
  scene.members.push_back(member);
  return scene;
}

std::vector<MeasuredMode> merged_modes(std::vector<MeasuredMode> modes) {
  std::ranges::stable_sort(modes, {}, [](const auto& mode) { return mode.frequency_hz.value; });
  std::vector<MeasuredMode> merged;
  std::vector<double> values, variances;
  for (const auto& mode : modes) {
    const auto& f = mode.frequency_hz;
    const bool same = !merged.empty() && mode.plane == merged.back().plane &&
                      std::abs(f.value - merged.back().frequency_hz.value) <
                          3 * std::hypot(f.std, merged.back().frequency_hz.std);
    if (!same) {
      merged.push_back(mode), values.clear(), variances.clear();
    }
    values.push_back(f.value), variances.push_back(f.std * f.std);
    if (!same) continue;
    const auto mean = signal::mean_over_groups(values, variances);
    merged.back().frequency_hz = {mean.mean, std::sqrt(mean.variance)};
  }
  return merged;
}

void check_cable(const CableDescription& cable, const std::vector<MeasuredMode>& modes) {
  const auto positive = [](double value, const char* what) {
    if (!(value > 0) || !std::isfinite(value))
      throw std::invalid_argument(std::string(what) + " must be positive");
  };
  positive(cable.length_m.value, "the length");
  positive(cable.mass_per_length.value, "the mass per length");
  if (cable.EI_Nm2 && !(cable.EI_Nm2->value >= 0 && std::isfinite(cable.EI_Nm2->value)))
    throw std::invalid_argument("EI must not be negative");
  if (cable.EA_N) positive(cable.EA_N->value, "EA");
  if (!(std::abs(cable.inclination_deg) <= 90))
    throw std::invalid_argument("the inclination is within +-90 degrees");
  for (const auto& mass : cable.masses) {
    if (!(mass.position > 0 && mass.position < 1)) {
      throw std::invalid_argument(
          "a mass on the cable is at a place between 0 and 1 of its length");
    }
    positive(mass.mass, "a mass on the cable");
  }
  if (modes.empty()) throw std::invalid_argument("no measured frequency");
  for (const auto& mode : modes) positive(mode.frequency_hz.value, "a measured frequency");
}

TensionResult identify_tension(const CableDescription& cable,
                               const std::vector<MeasuredMode>& modes,
                               const TensionOptions& options) {
  check_cable(cable, modes);
  const auto compared = compare(cable, modes, options);
  TensionResult result;
  for (const auto& one : compared.candidates) {
    result.candidates.push_back(candidate_of(cable, modes, one));
  }
  std::ranges::stable_sort(result.candidates, std::greater(), &TensionCandidate::weight);
  if (!result.candidates.front().solved) {
    std::vector<const char*> tried;
    for (const auto& one : result.candidates) tried.push_back(name_of(one.ends));
    result.message =
        fmt::format("no tension fits the frequencies; tried with ends {}", fmt::join(tried, ", "));
    return result;
  }
  const double factor = scene_tension_factor(cable);
  const auto& all = compared.averaged.front();
  result.tension_N = tension_of(all, factor);
  result.solved = std::isfinite(result.tension_N.std) && std::isfinite(result.tension_N.low) &&
                  std::isfinite(result.tension_N.high);
  if (!result.solved) {
    result.message = "the frequencies do not determine the tension";
    return result;
  }
  result.decided = decided_weight(compared) >= 0.9;
  const auto& heaviest = result.candidates.front();
  result.ruled_out = heaviest.fit.far_off() || chance_of(heaviest) < kChanceRuledOut;
  result.budget = budget_of(compared, factor);
  result.EI_Nm2 = heaviest.EI_Nm2;
  describe(cable, result);
  const double T = result.tension_N.value, strain = T / axial_rigidity(cable, T);
  result.mass_reference_matters = !cable.mass_reference && strain * T > result.tension_N.std / 3;
  return result;
}

}  // namespace rigfit::ident
