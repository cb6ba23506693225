#include "ident/update/model_update.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ident/update/answers.h"
#include "ident/update/fit.h"
#include "ident/update/intervals.h"
#include "ident/update/posterior.h"
#include "ident/update/segments.h"
#include "ident/update/unstated.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;

// The answer's values, and its pairs.
void state_values(const Likelihood& likelihood, const UpdateSolution& answer,
                  UpdateResult& result) {
  result.coordinates = answer.q;
  for (std::size_t j = 0; j < result.parameters.size(); ++j) {
    result.parameters[j].value =
        likelihood.coordinates()[j].value(answer.q[static_cast<Eigen::Index>(j)]);
  }
  result.pairs = likelihood.pairs(answer.q, answer.matches.matches);
  result.unpaired = answer.matches.unpaired;
  result.rms_relative_error = rms_of_pairs(result.pairs);
  if (likelihood.has_frfs()) {
    result.rms_log_frf_error = likelihood.rms_log_frf_error(answer.q);
    result.frf_lines = likelihood.frf_lines();
  }
}

// Everything in the result that follows from the answer. `by_segments`: of state_uncertainty.
void state_answer(const Likelihood& likelihood, const UpdateSolution& answer, UpdateResult& result,
                  const Eigen::VectorXd& by_segments = {}) {
  const auto& matches = answer.matches.matches;
  for (auto& parameter : result.parameters) parameter.budget.clear();
  result.status = answer.converged ? UpdateStatus::converged : UpdateStatus::not_converged;
  result.message.clear();
  result.open.clear();
  if (!answer.converged) {
    result.message =
        "the fit or its pairs had not settled; what is given is the best that was "
        "seen; ";
  }
  const auto data = likelihood.residual_count(matches, UpdateStage::full);
  if (likelihood.size() > data) {
    result.status = UpdateStatus::too_little_data;
    const auto unknowns = likelihood.parameters();
    result.message +=
        fmt::format("{} unknowns and {} data; ", unknowns, data - likelihood.size() + unknowns);
  }
  state_values(likelihood, answer, result);
  result.fit.correlated_lines = misfit_of(likelihood, matches, answer.q).correlated_lines;
  state_uncertainty(likelihood, matches, result, by_segments);
}

// The misfit of the answer, the error of the model that it asks for, and the answer with it.
void allow_for_misfit(Likelihood& settled, UpdateSolution& answer, UpdateResult& result) {
  const auto& matches = answer.matches.matches;
  settled.errors = {};
  const auto again = [&](const Likelihood& trial) {
    Eigen::VectorXd q = answer.q;
    double cost = 0;
    const bool converged = minimise(trial, matches, UpdateStage::full, trial.options(), q, cost);
    if (!converged && !trial.has_frfs()) return false;
    if (!converged && !robust_cost(trial, matches, UpdateStage::full, trial.options(), q, cost)) {
      return false;
    }
    answer.q = std::move(q);
    answer.cost = cost;
    if (trial.has_frfs()) answer.converged = converged;
    settled = trial;
    return true;
  };
  if (settled.has_frfs()) {
    Likelihood trial = settled;
    trial.frf_differences = true;
    trial.add_hits(answer.q);
    const Eigen::Index known = answer.q.size();
    answer.q.conservativeResize(trial.size());
    answer.q.tail(trial.size() - known).setZero();
    if (!again(trial)) settled = std::move(trial);
  }
  result.fit = misfit_of(settled, matches, answer.q);
  if (!(result.fit.p_value < kUnlikelyMisfit)) return;
  // Assumed uncertainties are scaled by the scatter; only Huber's loss should not take it for
  // outliers.
  if (!result.fit.stated &&
      (settled.has_frfs() || result.fit.chi2 < 2 * result.fit.degrees_of_freedom)) {
    return;
  }
  for (int pass = 0; pass < (settled.has_frfs() ? 1 : 2); ++pass) {
    const double tau = model_std_of(settled, matches, answer.q);
    if (!(tau > 0)) break;
    Likelihood trial = settled;
    (settled.has_frfs() ? trial.errors.frf : trial.errors.frequency) = tau;
    if (!again(trial)) break;
    (settled.has_frfs() ? result.fit.frf_model_std : result.fit.model_std) = tau;
  }
  if (!settled.has_frfs()) {  // the misfit at the answer that is stated
    const double tau = result.fit.model_std;
    result.fit = misfit_of(settled, matches, answer.q);
    result.fit.model_std = tau;
  }
}

// FRFs with segments that resolve them: see segments.h.
void resolve(Likelihood& settled, UpdateSolution& answer, UpdateResult& result) {
  if (!settled.options().segment_uncertainty || !settled.has_frfs()) return;
  const bool given = has_given_segments(settled, -1);
  const int first = settled.mesh.auto_segments;
  Likelihood fine = settled;
  UpdateSolution finest = answer;
  UpdateResult trial = result;
  for (const int factor : {2, 4, 8}) {
    if (!(segment_excess(fine, answer.matches.matches, trial) > 1)) break;
    Likelihood finer = fine;
    UpdateSolution next = finest;
    if (given) {
      finer.mesh.factor = factor;
    } else {
      finer.mesh.auto_segments = factor * first;
    }
    finer.errors = {};
    next.converged = minimise(finer, next.matches.matches, UpdateStage::full, finer.options(),
                              next.q, next.cost);
    if (!next.converged) break;
    allow_for_misfit(finer, next, trial);
    state_answer(finer, next, trial);
    fine = std::move(finer);
    finest = std::move(next);
  }
  result.auto_segments = fine.mesh.auto_segments;
  if (!given) {
    const bool moved = fine.mesh.auto_segments != first;
    settled = std::move(fine), answer = std::move(finest);
    if (moved) result.fit = trial.fit;
    state_answer(settled, answer, result);
    return;
  }
  if (fine.mesh.factor == settled.mesh.factor) return;
  // What is reported is the model with the segments that its scene gives.
  Eigen::VectorXd by_segments = answer.q - finest.q;
  for (std::size_t p = 0; p < trial.parameters.size(); ++p) {
    const auto j = static_cast<Eigen::Index>(p);
    const double left = trial.parameters[p].segment_shift;
    if (std::isfinite(left)) by_segments[j] += left / fine.coordinates()[p].derivative(finest.q[j]);
  }
  result.fit = trial.fit;
  state_answer(fine, finest, result, by_segments);
  state_values(settled, answer, result);
  state_prediction_uncertainty(settled, result, answer.q, -1, result.pairs);
}

UpdateAlternative alternative_of(const UpdateAnswer& answer, const UpdateResult& result) {
  UpdateAlternative alternative;
  alternative.weight = answer.weight;
  alternative.log_evidence = answer.log_evidence;
  alternative.log_detected = answer.solution.matches.log_detected;
  alternative.log_false = answer.solution.matches.log_false;
  alternative.log_missed = answer.solution.matches.log_missed;
  alternative.parameters = result.parameters;
  alternative.pairs = result.pairs;
  alternative.unpaired = result.unpaired;
  alternative.rms_relative_error = result.rms_relative_error;
  alternative.model_std = result.fit.model_std;
  return alternative;
}

// The answers beside the first, each with its own uncertainty; then the intervals of all together.
void state_alternatives(const Likelihood& likelihood, const std::vector<UpdateAnswer>& answers,
                        UpdateResult& result) {
  for (std::size_t k = 1; k < answers.size(); ++k) {
    UpdateResult other;
    other.parameters = result.parameters;
    for (auto& parameter : other.parameters) {
      parameter.std = parameter.low = parameter.high = kNaN;
    }
    UpdateSolution solution = answers[k].solution;
    Likelihood settled = likelihood;
    take_segments_off(settled, solution);
    allow_for_misfit(settled, solution, other);
    state_answer(settled, solution, other);
    state_intervals(settled, solution.matches.matches, other);
    result.alternatives.push_back(alternative_of(answers[k], other));
  }
  if (answers.size() > 1) state_mixture(result);
}

}  // namespace

const char* name_of(UpdateStatus status) {
  switch (status) {
    case UpdateStatus::converged:
      return "converged";
    case UpdateStatus::not_converged:
      return "not converged";
    case UpdateStatus::no_model:
      return "no model";
    case UpdateStatus::too_little_data:
      return "too little data";
  }
  return "not converged";
}

namespace {

// Fits to modes: all answers. Others: the best of the starts.
std::vector<UpdateAnswer> answers_of(const Likelihood& likelihood, const UpdateOptions& options,
                                     UpdateResult& result, std::string& failure) {
  if (likelihood.modes_only()) {
    auto answers = find_answers(likelihood, options, result.starts, failure);
    double all = 0;
    for (const auto& answer : answers) {
      const double more = answer.log_evidence - answers.front().log_evidence;
      all += std::exp(more);
      result.pairings += answer.solution.pairings;
    }
    if (!answers.empty()) result.log_evidence = answers.front().log_evidence + std::log(all);
    result.starts_agreeing = result.starts;
    return answers;
  }
  const auto solved = solve_from_all_starts(likelihood, options);
  const UpdateSolution* best = nullptr;
  for (const auto& one : solved) {
    if (one.q.size() > 0 && (best == nullptr || one.cost < best->cost)) best = &one;
  }
  result.starts = static_cast<int>(solved.size());
  if (best == nullptr) {
    failure = solved.front().failure;
    return {};
  }
  for (const auto& one : solved) {
    result.pairings += one.pairings;
    // The same answer: a cost that differs by less than what a hundredth of a standard deviation
    // in one residual makes.
    result.starts_agreeing += one.q.size() > 0 && one.cost <= best->cost * (1 + 1e-4) + 1e-4;
  }
  std::vector<UpdateAnswer> answers(1);
  answers.front().solution = *best;
  return answers;
}

}  // namespace

UpdateResult update_result(const Likelihood& likelihood) {
  const UpdateOptions& options = likelihood.options();
  UpdateResult result;
  const Eigen::VectorXd start = likelihood.start();
  const auto names = likelihood.names();
  if (likelihood.parameters() == 0) throw std::invalid_argument("update: no free parameter");
  for (std::size_t j = 0; j < static_cast<std::size_t>(likelihood.parameters()); ++j) {
    const auto& coordinate = likelihood.coordinates()[j];
    const double value = coordinate.value(start[static_cast<Eigen::Index>(j)]);
    result.parameters.push_back({.name = names[j],
                                 .state = coordinate.state,
                                 .start = value,
                                 .value = value,
                                 .std = kNaN,
                                 .std_from_data = kNaN});
  }
  result.rms_relative_error = result.rms_relative_error_before = kNaN;
  std::string failure;
  const UpdateMatches before = likelihood.match(start, 1, failure);
  if (failure.empty()) {
    result.pairs_before = likelihood.pairs(start, before.matches);
    result.rms_relative_error_before = rms_of_pairs(result.pairs_before);
  }
  if (likelihood.has_frfs()) result.rms_log_frf_error_before = likelihood.rms_log_frf_error(start);

  const std::vector<UpdateAnswer> answers = answers_of(likelihood, options, result, failure);
  if (answers.empty()) {
    result.status = UpdateStatus::no_model;
    result.message = "from no start could the model be fitted: " + failure;
    result.model_evaluations = likelihood.evaluations();
    return result;
  }
  UpdateSolution answer = answers.front().solution;
  Likelihood settled = likelihood;
  take_segments_off(settled, answer);
  allow_for_misfit(settled, answer, result);
  result.auto_segments = options.auto_segments;
  state_answer(settled, answer, result);
  resolve(settled, answer, result);
  const auto& matches = answer.matches.matches;
  state_exact_inputs(settled, matches, result);
  state_intervals(settled, matches, result);
  if (likelihood.modes_only()) {
    result.alternatives.push_back(alternative_of(answers.front(), result));
    state_alternatives(likelihood, answers, result);
  }
  for (int s = 0; s < static_cast<int>(likelihood.states().size()); ++s) {
    result.scenes.push_back(settled.scene_at(s, result.coordinates));
  }
  result.model_evaluations = likelihood.evaluations();
  result.likelihood = std::make_shared<const Likelihood>(std::move(settled));
  if (result.message.ends_with("; ")) result.message.resize(result.message.size() - 2);
  return result;
}

UpdateResult update_model(const std::vector<UpdateState>& states,
                          const std::vector<FreeParameter>& free, const UpdateOptions& options) {
  return update_result(Likelihood(states, free, options));
}

PairedModes compare_with_measured(const std::vector<UpdateState>& states,
                                  const UpdateOptions& options) {
  const Likelihood likelihood(states, {}, options);
  PairedModes result;
  std::string failure;
  const Eigen::VectorXd start = likelihood.start();
  const auto matches = likelihood.match(start, 1, failure);
  if (!failure.empty()) return result;
  result.pairs = likelihood.pairs(start, matches.matches);
  result.unpaired = matches.unpaired;
  result.rms_relative_error = rms_of_pairs(result.pairs);
  return result;
}

}  // namespace rigfit::ident
