#include "ident/tension/cable_tension.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "ident/tension/cable_model.h"
#include "ident/tension/tension_posterior.h"
#include "signal/estimation/groups.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {

namespace {

using signal::Estimate;
using signal::kNaN;

constexpr double kInf = std::numeric_limits<double>::infinity();

constexpr double kSettled = 3e-5;  // change of ln f
// Beyond these what was measured is no such cable: 3 % is the largest error of the model that is
// summed over, and a sound one reaches it in few modes only.
constexpr double kRmsRuledOut = 0.02, kWorstRuledOut = 0.05, kChanceRuledOut = 1e-6;
constexpr double kSoundModel = 5e-3;  // error of the model that the chance counts, at most
constexpr double kSameCell = 1e-3;    // change of ln T: fits of one cell from two starts

/// Whether the heaviest cell of an answer is one of another answer: two starts have led to one.
bool contained(const TensionAnswer& answer, const TensionAnswer& other) {
  if (answer.modes != other.modes) return false;
  const auto& cell = answer.cells[answer.best];
  return std::any_of(other.cells.begin(), other.cells.end(), [&](const auto& one) {
    return std::abs(one.ln_tension - cell.ln_tension) < kSameCell &&
           one.model_std == cell.model_std && one.shape.x == cell.shape.x &&
           one.shape.q == cell.shape.q;
  });
}

/// Answers of all assignments, heaviest first. `best`: ln of the evidence of the best answer with
/// other ends.
void evaluate(EndsPosterior& one, const TensionData& data,
              const std::vector<Assignment>& assignments, double best) {
  one.answers.clear();
  for (const auto& assignment : assignments) {
    auto answer = tension_answer(one.model, data, one.ends, assignment, best);
    if (answer.cells.empty() || !std::isfinite(answer.ln_evidence)) continue;
    best = std::max(best, answer.ln_evidence);
    const bool known = std::any_of(one.answers.begin(), one.answers.end(),
                                   [&](const auto& other) { return contained(answer, other); });
    if (known) continue;
    std::erase_if(one.answers, [&](const auto& other) { return contained(other, answer); });
    one.answers.push_back(std::move(answer));
  }
  std::stable_sort(one.answers.begin(), one.answers.end(),
                   [](const auto& a, const auto& b) { return a.ln_evidence > b.ln_evidence; });
  if (one.answers.empty()) return;
  const double top = one.answers.front().ln_evidence;
  double sum = 0;
  for (const auto& answer : one.answers) sum += std::exp(answer.ln_evidence - top);
  one.ln_evidence = top + std::log(sum);
}

/// The correction at the heaviest answer; returns by how much it changes ln f.
double correct(EndsPosterior& one) {
  if (!one.model.needs_correction(one.state().tension_N)) return 0;
  int count = 2;
  for (const auto& mode : one.answers.front().modes) count = std::max(count, mode.order + 1);
  std::string why;
  auto correction = segment_correction(one.model, one.ends, one.state(), count, why);
  if (correction.in.empty() || correction.out.empty()) {
    one.corrected = false;
    return 0;
  }
  double change = 0;
  for (const auto plane : {&CableCorrection::in, &CableCorrection::out}) {
    const auto &now = correction.*plane, &before = one.model.correction().*plane;
    for (std::size_t i = 0; i < now.size(); ++i) {
      const double old = before.empty() ? 0 : before[std::min(i, before.size() - 1)];
      change = std::max(change, std::abs(now[i] - old));
    }
  }
  one.model = CableModel(one.model.cable(), std::move(correction));
  return change;
}

CableFrequencies frequencies_of(const EndsPosterior& one, const TensionAnswer& answer,
                                const TensionData& data) {
  return one.model.frequencies(answer.state(), 200, 1.05 * data.highest_hz);
}

/// Order of each measured mode among those of its plane by rising frequency, from 1; 0: none.
std::vector<int> orders(const EndsPosterior& one, const TensionAnswer& answer,
                        const TensionData& data) {
  const auto frequencies = frequencies_of(one, answer, data);
  std::vector<int> found;
  for (const auto& mode : answer.modes) {
    const auto& list = mode.plane == model::ModePlane::in ? frequencies.in_hz : frequencies.out_hz;
    const auto place = static_cast<std::size_t>(std::max(0, mode.order));
    if (mode.order < 0 || place >= list.size()) {
      found.push_back(mode.order + 1);
    } else {
      const auto below =
          std::count_if(list.begin(), list.end(), [&](double hz) { return hz < list[place]; });
      found.push_back(1 + static_cast<int>(below));
    }
  }
  return found;
}

/// Order of each measured mode, and how well it agrees.
void list_modes(const EndsPosterior& one, const TensionData& data, TensionCandidate& candidate) {
  const auto& answer = one.answers.front();
  const auto frequencies = frequencies_of(one, answer, data);
  const auto order_of = orders(one, answer, data);
  std::vector<TensionData::Listed> listed;
  data.list(frequencies, listed);
  double last = -kInf;  // the highest paired frequency
  for (std::size_t i = 0; i < data.modes.size(); ++i) {
    TensionMode mode;
    mode.measured_hz = data.modes[i].frequency_hz.value;
    mode.measured_std_hz = data.modes[i].frequency_hz.std;
    mode.model_hz = mode.relative_error = kNaN;
    const auto& assigned = answer.modes[i];
    if (assigned.order >= 0) {
      const auto& list =
          assigned.plane == model::ModePlane::in ? frequencies.in_hz : frequencies.out_hz;
      const auto place = static_cast<std::size_t>(assigned.order);
      last = data.ln_hz[i];
      mode.order = order_of[i];
      mode.plane = assigned.plane;
      if (place < list.size()) {
        mode.model_hz = list[place];
        mode.relative_error = list[place] / mode.measured_hz - 1;
      }
    }
    candidate.modes.push_back(mode);
  }
  for (const auto& mode : listed) {
    const bool found =
        std::find(answer.modes.begin(), answer.modes.end(), mode.mode) != answer.modes.end();
    // One that is seen with a probability of more than a half.
    candidate.missed += !found && mode.ln_hz < last && mode.ln_unseen < -0.7;
  }
}

TensionCandidate candidate_of(const EndsPosterior& one, const TensionData& data) {
  TensionCandidate candidate;
  candidate.ends = one.ends;
  candidate.spring_Nm_rad = {kNaN, kNaN};
  if (one.answers.empty()) {
    candidate.message = "no tension fits the frequencies with these ends";
    return candidate;
  }
  candidate.solved = true;
  if (!one.corrected) {
    candidate.message =
        "the segment model has no equilibrium there: deep sag or masses are not corrected for";
  }
  const auto summary = summarise_tension({&one});
  candidate.tension_N = summary.tension;
  candidate.low = summary.low;
  candidate.high = summary.high;
  const auto& cable = one.model.cable();
  candidate.EI_Nm2 = EI_is_exact(cable) ? Estimate{cable.EI_Nm2->value, 0} : summary.EI;
  if (one.ends == CableEnds::springs) candidate.spring_Nm_rad = summary.spring;
  candidate.budget = summary.budget;
  const auto& answer = one.answers.front();
  const auto& cell = answer.cells[answer.best];
  int pairs = 0;
  for (const auto& mode : answer.modes) pairs += mode.order >= 0;
  // What the frequencies have to explain: T, EI unless given, springs.
  const int unknowns = 1 + !cable.EI_Nm2 + (one.ends == CableEnds::springs);
  candidate.fit.stated = data.stated;
  double chi2 = kInf;
  for (const auto& other : answer.cells) {
    // The least with t = 0 in the weights.
    if (other.model_std == 0 && other.ln_weight > cell.ln_weight - 18)
      chi2 = std::min(chi2, other.chi2_stated);
  }
  candidate.fit.chi2 = std::isfinite(chi2) ? chi2 : cell.chi2_stated;
  candidate.fit.degrees_of_freedom = std::max(0, pairs - unknowns);
  if (data.stated && candidate.fit.degrees_of_freedom > 0)
    candidate.fit.p_value = gsl_cdf_chisq_Q(candidate.fit.chi2, candidate.fit.degrees_of_freedom);
  candidate.fit.model_std = cell.model_std;
  list_modes(one, data, candidate);
  double squares = 0, weighted = 0;
  for (const auto& mode : candidate.modes) {
    if (mode.order == 0 || !std::isfinite(mode.relative_error)) continue;
    const double square = mode.relative_error * mode.relative_error;
    const double own = data.stated ? mode.measured_std_hz / mode.measured_hz : 0;
    const double of_model = data.stated ? std::min(cell.model_std, kSoundModel) : cell.model_std;
    squares += square;
    weighted += square / (own * own + of_model * of_model);
    candidate.worst_error = std::max(candidate.worst_error, std::sqrt(square));
  }
  candidate.rms_error = std::sqrt(squares / std::max(1, pairs));
  if (candidate.fit.degrees_of_freedom > 0 && weighted > 0 && std::isfinite(weighted)) {
    candidate.p_with_model_error = gsl_cdf_chisq_Q(weighted, candidate.fit.degrees_of_freedom);
  }
  return candidate;
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
void describe(const CableModel& model, TensionResult& result) {
  const auto& best = result.candidates.front();
  const auto& cable = model.cable();
  const double L = cable.length_m.value, T = result.tension_N.value,
               angle = cable.inclination_deg * signal::kTwoPi / 360;
  const double weight = cable.mass_per_length.value * cable.gravity;
  result.sag_m = model.weight_across() * L * L / (8 * T);
  const double rise = L * std::sin(angle), middle = rise / 2 - result.sag_m * std::cos(angle);
  result.start_N = T - weight * middle;
  result.end_N = T + weight * (rise - middle);
  result.irvine_parameter = model.lambda_squared(T);
  result.bending_parameter = L * std::sqrt(T / best.EI_Nm2.value);
  const auto lowest = std::find_if(best.modes.begin(), best.modes.end(),
                                   [](const auto& mode) { return mode.order > 0; });
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

/// The answers that may still be the best, as starts.
std::vector<Assignment> surviving(const EndsPosterior& one) {
  std::vector<Assignment> kept;
  for (const auto& answer : one.answers) {
    if (answer.ln_evidence < one.answers.front().ln_evidence - 20) break;
    const auto& cell = answer.cells[answer.best];
    kept.push_back({answer.modes, 0, cell.ln_tension, cell.state.EA, cell.shape});
  }
  return kept;
}

/// Repeats correction and posterior until the correction at the heaviest answer stays; how much the
/// first one changed ln f.
double settle(EndsPosterior& one, const TensionData& data, double best) {
  double first = 0;
  for (int i = 0; i < 8 && !one.answers.empty(); ++i) {
    const double change = correct(one);
    first = std::max(first, change);
    if (change < kSettled) break;
    evaluate(one, data, surviving(one), best);
  }
  return first;
}

/// Posteriors of all kinds of ends, the correction repeated until it stays.
std::vector<EndsPosterior> posteriors(const CableDescription& cable, const TensionData& data,
                                      const std::vector<CableEnds>& kinds) {
  std::vector<EndsPosterior> all;
  all.reserve(kinds.size());
  for (const CableEnds ends : kinds) {
    all.push_back({ends, CableModel(cable), {}, -kInf, true});
  }
  CableModel searched(cable);
  for (int round = 0; round < 3; ++round) {
    const auto assignments = search_assignments(searched, data);
    double change = 0;
    const EndsPosterior* heaviest = nullptr;
    for (auto& one : all) {
      const double best = heaviest != nullptr ? heaviest->ln_evidence : -kInf;
      evaluate(one, data, assignments, best);
      if (one.answers.empty()) continue;
      change = std::max(change, settle(one, data, best));
      if (!one.answers.empty() && (heaviest == nullptr || one.ln_evidence > heaviest->ln_evidence))
        heaviest = &one;
    }
    // A correction beyond the search's own tolerance can hide the right assignment.
    if (heaviest == nullptr || change < 0.005) break;
    searched = heaviest->model;
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.ln_evidence > b.ln_evidence; });
  return all;
}

}  // namespace

std::vector<MeasuredMode> merged_modes(std::vector<MeasuredMode> modes) {
  std::stable_sort(modes.begin(), modes.end(), [](const auto& a, const auto& b) {
    return a.frequency_hz.value < b.frequency_hz.value;
  });
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
  TensionResult result;
  const TensionData data(modes, options);
  const auto all = posteriors(cable, data, options.ends);
  std::vector<const EndsPosterior*> solved;
  for (const auto& one : all) {
    result.candidates.push_back(candidate_of(one, data));
    if (!one.answers.empty()) solved.push_back(&one);
  }
  if (solved.empty()) {
    result.message = "no tension fits the frequencies; tried with ends";
    for (const auto& one : all) {
      result.message += fmt::format("{} {}", &one == &all.front() ? "" : ",", name_of(one.ends));
    }
    return result;
  }
  double sum = 0, decided = 0;
  for (const auto* one : solved) sum += std::exp(one->ln_evidence - solved.front()->ln_evidence);
  const auto of_best = orders(*solved.front(), solved.front()->answers.front(), data);
  for (std::size_t i = 0; i < solved.size(); ++i) {
    result.candidates[i].weight =
        std::exp(solved[i]->ln_evidence - solved.front()->ln_evidence) / sum;
    for (const auto& answer : solved[i]->answers) {
      if (orders(*solved[i], answer, data) == of_best) {
        decided +=
            result.candidates[i].weight * std::exp(answer.ln_evidence - solved[i]->ln_evidence);
      }
    }
  }
  result.solved = true;
  result.decided = decided >= 0.9;
  const auto& heaviest = result.candidates.front();
  result.ruled_out = heaviest.rms_error > kRmsRuledOut || heaviest.worst_error > kWorstRuledOut ||
                     heaviest.p_with_model_error < kChanceRuledOut;
  const auto summary = summarise_tension(solved);
  result.tension_N = summary.tension;
  result.low = summary.low;
  result.high = summary.high;
  result.budget = summary.budget;
  result.EI_Nm2 = result.candidates.front().EI_Nm2;
  result.large_sag = !solved.front()->corrected;
  const auto& model = solved.front()->model;
  describe(model, result);
  const double T = result.tension_N.value, strain = T / model.axial_rigidity(T);
  result.EA_assumed = !cable.EA_N;
  result.EI_assumed = !cable.EI_Nm2 && modes.size() < 3;
  result.mass_reference_matters = !cable.mass_reference && strain * T > result.tension_N.std / 3;
  return result;
}

}  // namespace rigfit::ident
