#include "ident/update/model_update.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ident/update/assignment/update_alternatives.h"
#include "ident/update/problem/update_problem.h"
#include "ident/update/problem/update_solver.h"
#include "ident/update/uncertainty/update_intervals.h"
#include "ident/update/uncertainty/update_misfit.h"
#include "ident/update/uncertainty/update_segments.h"
#include "ident/update/uncertainty/update_uncertainty.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;

// The answer's values, and its pairs.
void state_values(const UpdateProblem& problem, const UpdateSolution& answer,
                  UpdateResult& result) {
  const auto& coordinates = problem.coordinates();
  result.coordinates = answer.q;
  for (std::size_t j = 0; j < result.parameters.size(); ++j) {
    result.parameters[j].value = coordinates[j].value(answer.q[static_cast<Eigen::Index>(j)]);
  }
  result.pairs = problem.pairs(answer.q, answer.matches.matches);
  result.unpaired = answer.matches.unpaired;
  result.rms_relative_error = rms_of_pairs(result.pairs);
  if (problem.has_frfs()) {
    result.rms_log_frf_error = problem.rms_log_frf_error(answer.q);
    result.frf_lines = problem.frf_lines();
  }
}

// Everything in the result that follows from the answer.
void state_answer(const UpdateProblem& problem, const UpdateOptions& options,
                  const UpdateSolution& answer, UpdateResult& result) {
  const auto& matches = answer.matches.matches;
  for (auto& parameter : result.parameters) parameter.budget.clear();
  result.status = answer.converged ? UpdateStatus::converged : UpdateStatus::not_converged;
  result.message.clear();
  if (!answer.converged) {
    result.message =
        "Try other start values or narrower bounds: the fit or its pairs had not settled, and the "
        "best values so far are given; ";
  }
  const auto data = problem.residual_count(matches);
  if (problem.size() > data) {
    result.status = UpdateStatus::too_little_data;
    result.message += fmt::format("{} unknowns and {} data; ", problem.size(), data);
  }
  state_values(problem, answer, result);
  result.open.clear();
  const UpdateFit before = result.fit;
  result.fit = misfit_of(problem, matches, answer.q);
  result.fit.model_std = before.model_std;
  if (before.frf_model_std > 0) {  // the misfit is that without the error that it asked for
    const double correlated = result.fit.correlated_lines;
    result.fit = before;
    result.fit.correlated_lines = correlated;
  }
  state_uncertainty(problem, options, matches, result);
}

// The search weighs the data with an error of the model; where they agree without it, they alone
// have the answer.
void take_error_off(const UpdateProblem& problem, const UpdateOptions& options,
                    UpdateSolution& answer) {
  if (!problem.modes_only()) return;
  Eigen::VectorXd q = answer.q;
  double cost = 0;
  if (minimise(problem, answer.matches.matches, options, q, cost) &&
      misfit_of(problem, answer.matches.matches, q).p_value > kUnlikelyMisfit) {
    answer.q = std::move(q);
  }
}

// The problem with everything that is known to an uncertainty, and the answer in it.
UpdateProblem whole_problem(const UpdateProblem& problem, const UpdateOptions& options,
                            UpdateSolution& answer) {
  const UpdateProblem whole = problem.with_nuisances(answer.q);
  take_error_off(whole, options, answer);
  return take_segments_off(whole, options, answer);
}

// The error of the model that the misfit at the answer asks for, and the answer with it.
void allow_for_misfit(const UpdateOptions& options, UpdateProblem& settled, UpdateSolution& answer,
                      UpdateResult& result) {
  result.fit.model_std = 0;
  settled = settled.with_model_std(0);
  if (!settled.modes_only()) return;
  const UpdateFit fit = misfit_of(settled, answer.matches.matches, answer.q);
  if (!(fit.p_value < kUnlikelyMisfit)) return;
  const auto& matches = answer.matches.matches;
  const double tau = model_std_of(settled, matches, answer.q);
  if (!(tau > 0)) return;
  const UpdateProblem trial = settled.with_model_std(tau);
  Eigen::VectorXd q = answer.q;
  double cost = 0;
  if (!minimise(trial, matches, options, q, cost)) return;
  answer.q = std::move(q);
  settled = trial;
  result.fit.model_std = tau;
}

UpdateAlternative alternative_of(const UpdateAnswer& answer, const UpdateResult& result) {
  UpdateAlternative alternative;
  alternative.weight = answer.weight;
  alternative.log_evidence = answer.log_evidence;
  alternative.add(answer.solution.matches);
  alternative.parameters = result.parameters;
  alternative.pairs = result.pairs;
  alternative.unpaired = result.unpaired;
  alternative.rms_relative_error = result.rms_relative_error;
  alternative.model_std = result.fit.model_std;
  return alternative;
}

// The answers beside the first, each with its own uncertainty; then the intervals of all together.
void state_alternatives(const UpdateProblem& problem, const UpdateOptions& options,
                        const std::vector<UpdateAnswer>& answers, UpdateResult& result) {
  for (std::size_t k = 1; k < answers.size(); ++k) {
    UpdateResult other;
    other.parameters = result.parameters;
    for (auto& parameter : other.parameters) {
      parameter.std = parameter.low = parameter.high = kNaN;
    }
    UpdateSolution solution = answers[k].solution;
    UpdateProblem settled = whole_problem(problem, options, solution);
    allow_for_misfit(options, settled, solution, other);
    state_answer(settled, options, solution, other);
    state_intervals(settled, options, solution.matches.matches, other);
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

// Fits to modes: all answers. Fits of FRFs: the best that begins with one of their modes' answers,
// or where the scene is; `problem` becomes the one whose segments resolve them.
std::vector<UpdateAnswer> answers_of(UpdateProblem& problem, const UpdateOptions& options,
                                     UpdateResult& result, std::string& failure) {
  std::vector<UpdateAnswer> answers;
  if (problem.has_modes()) {
    answers = find_answers(problem.modes_alone(), options, result.starts, failure);
  } else if (problem.has_frfs()) {
    answers.resize(1);
    answers.front().solution.q = problem.start();
    result.starts = 1;
  } else {
    failure = "no mode and no FRF was measured";
  }
  for (const auto& answer : answers) result.pairings += answer.solution.pairings;
  if (answers.empty()) return answers;
  if (problem.modes_only()) {
    double all = 0;
    for (const auto& answer : answers) {
      all += std::exp(answer.log_evidence - answers.front().log_evidence);
    }
    result.log_evidence = answers.front().log_evidence + std::log(all);
    return answers;
  }
  if (options.segment_uncertainty) {
    const auto& first = answers.front().solution;
    problem = with_resolving_segments(problem, first.matches.matches, first.q);
    result.segment_factor = problem.variant().segment_factor;
  }
  UpdateAnswer best;
  for (auto& answer : answers) {
    auto& solution = answer.solution;
    solution.converged =
        minimise(problem, solution.matches.matches, options, solution.q, solution.cost);
    if (!cost_of(problem, solution.matches.matches, solution.q, solution.cost)) {
      continue;
    }
    if (solution.cost < best.solution.cost) best = answer;
  }
  failure = "no response of the model there";
  return best.solution.q.size() > 0 ? std::vector<UpdateAnswer>{best} : std::vector<UpdateAnswer>{};
}

}  // namespace

namespace {

/// A fit with the error of the scenes' own segments taken off says what they shift.
void state_segment_shifts(const UpdateProblem& settled, const UpdateOptions& options,
                          const UpdateSolution& answer, UpdateResult& result) {
  const auto& states = settled.states();
  const bool given = std::any_of(states.begin(), states.end(), [](const UpdateState& state) {
    return std::any_of(state.scene.members.begin(), state.scene.members.end(),
                       [](const auto& member) { return member.segments != 0; });
  });
  if (!given || !options.segment_uncertainty || !options.intervals || !settled.modes_only()) return;
  const UpdateProblem resolved = settled.with_resolved_modes(answer.q, true);
  Eigen::VectorXd q = answer.q;
  double cost = 0;
  if (!minimise(resolved, answer.matches.matches, options, q, cost)) return;
  for (std::size_t j = 0; j < result.parameters.size(); ++j) {
    auto& parameter = result.parameters[j];
    parameter.segment_shift =
        parameter.value - settled.coordinates()[j].value(q[static_cast<Eigen::Index>(j)]);
  }
}

}  // namespace

UpdateResult update_result(UpdateProblem problem, const UpdateOptions& options) {
  UpdateResult result;
  const auto& coordinates = problem.coordinates();
  if (coordinates.empty()) throw std::invalid_argument("update: no free parameter");
  const Eigen::VectorXd start = problem.start();
  const auto names = problem.names();
  for (std::size_t j = 0; j < coordinates.size(); ++j) {
    const double value = coordinates[j].value(start[static_cast<Eigen::Index>(j)]);
    result.parameters.push_back({.name = names[j],
                                 .state = coordinates[j].state,
                                 .start = value,
                                 .value = value,
                                 .std = kNaN,
                                 .std_from_data = kNaN});
  }
  result.rms_relative_error = result.rms_relative_error_before = kNaN;
  std::string failure;
  const UpdateMatches before = problem.match(start, failure);
  if (failure.empty()) {
    result.pairs_before = problem.pairs(start, before.matches);
    result.rms_relative_error_before = rms_of_pairs(result.pairs_before);
  }

  if (problem.has_frfs()) result.rms_log_frf_error_before = problem.rms_log_frf_error(start);

  std::vector<UpdateAnswer> answers = answers_of(problem, options, result, failure);
  if (answers.empty()) {
    result.status = UpdateStatus::no_model;
    result.message =
        "Check the scene and the bounds: from no start could the model be fitted, " + failure;
    result.model_evaluations = problem.evaluations();
    return result;
  }
  UpdateSolution answer = answers.front().solution;
  UpdateProblem settled = whole_problem(problem, options, answer);
  allow_for_misfit(options, settled, answer, result);
  settle_frfs(options, settled, answer, result);
  state_answer(settled, options, answer, result);
  state_intervals(settled, options, answer.matches.matches, result);
  state_segment_shifts(settled, options, answer, result);
  if (problem.modes_only() && options.intervals) {
    result.alternatives.push_back(alternative_of(answers.front(), result));
    state_alternatives(problem, options, answers, result);
  }
  for (int s = 0; s < static_cast<int>(problem.states().size()); ++s) {
    result.scenes.push_back(settled.scene_at(s, result.coordinates));
  }
  result.model_evaluations = problem.evaluations();
  if (result.message.ends_with("; ")) result.message.resize(result.message.size() - 2);
  return result;
}

UpdateResult update_model(const std::vector<UpdateState>& states,
                          const std::vector<FreeParameter>& free, const UpdateOptions& options) {
  return update_result(UpdateProblem(states, free, options), options);
}

}  // namespace rigfit::ident
