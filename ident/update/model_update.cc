#include "ident/update/model_update.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ident/update/contradicting_modes.h"
#include "ident/update/update_problem.h"
#include "ident/update/update_segments.h"
#include "ident/update/update_solver.h"
#include "ident/update/update_uncertainty.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;

constexpr int kRefinements = 3;

// Perhaps nothing but wrong pairs far from the truth: twice as many starts, ten times as far. Taken
// when they explain the data, and no fewer of them.
template <typename Count>
void look_wider(const UpdateProblem& problem, const UpdateOptions& options, UpdateSolution& answer,
                UpdateProblem& settled, const Count& count, UpdateResult& result) {
  UpdateOptions wider = options;
  wider.start_spread = 10 * options.start_spread;
  wider.starts = 2 * options.starts + 1;
  ++wider.seed;
  std::vector<UpdateSolution> found;
  for (auto& one : solve_from_all_starts(settled, wider)) {
    if (one.q.size() > 0 && one.matches.unpaired_measured <= answer.matches.unpaired_measured &&
        !is_misfit(settled, one)) {
      found.push_back(std::move(one));
    }
  }
  if (found.empty()) return;
  answer = *std::min_element(found.begin(), found.end(),
                             [](const auto& a, const auto& b) { return a.cost < b.cost; });
  result.starts_agreeing = 0;
  count(found, answer.cost);
  settled = take_segments_off(problem, options, answer);
}

// Everything in the result that follows from the answer.
void state_answer(const UpdateProblem& problem, const UpdateOptions& options,
                  const UpdateSolution& answer, UpdateResult& result) {
  const auto& coordinates = problem.coordinates();
  const auto& matches = answer.matches.matches;
  const auto data = problem.residual_count(matches, UpdateStage::full);
  result.coordinates = answer.q;
  for (std::size_t j = 0; j < coordinates.size(); ++j) {
    auto& parameter = result.parameters[j];
    parameter.value = coordinates[j].value(answer.q[static_cast<Eigen::Index>(j)]);
    parameter.budget.clear();
  }
  result.status = answer.converged ? UpdateStatus::converged : UpdateStatus::not_converged;
  result.message.clear();
  if (!answer.converged) {
    result.message =
        "the fit or its pairs had not settled; what is given is the best that was "
        "seen; ";
  }
  if (static_cast<Eigen::Index>(coordinates.size()) > data) {
    result.status = UpdateStatus::too_little_data;
    result.message += fmt::format("{} unknowns and {} data; ", coordinates.size(), data);
  }
  result.pairs = problem.pairs(answer.q, matches);
  result.unpaired = answer.matches.unpaired;
  result.rms_relative_error = rms_of_pairs(result.pairs);
  if (problem.has_frfs()) {
    result.rms_log_frf_error = problem.rms_log_frf_error(answer.q);
    result.frf_lines = problem.frf_lines();
  }
  if (problem.has_histories()) result.history_error = problem.history_error(answer.q);
  result.shift_sources.clear();
  result.open.clear();
  state_uncertainty(problem, options, matches, result);
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

UpdateResult update_result(const UpdateProblem& problem, const UpdateOptions& options) {
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
  const UpdateMatches before = problem.match(start, 1, failure);
  if (failure.empty()) {
    result.pairs_before = problem.pairs(start, before.matches);
    result.rms_relative_error_before = rms_of_pairs(result.pairs_before);
  }

  if (problem.has_frfs()) result.rms_log_frf_error_before = problem.rms_log_frf_error(start);
  if (problem.has_histories()) result.history_error_before = problem.history_error(start);

  auto solved = solve_from_all_starts(problem, options);
  const UpdateSolution* best = nullptr;
  for (const auto& one : solved) {
    if (one.q.size() > 0 && (best == nullptr || one.cost < best->cost)) best = &one;
  }
  const auto count = [&result](const std::vector<UpdateSolution>& some, double cost) {
    result.starts += static_cast<int>(some.size());
    for (const auto& one : some) {
      result.pairings += one.pairings;
      // The same answer: a cost that differs by less than what a hundredth of a standard deviation
      // in one residual makes.
      result.starts_agreeing += one.q.size() > 0 && one.cost <= cost * (1 + 1e-4) + 1e-4;
    }
  };
  count(solved, best != nullptr ? best->cost : 0);
  if (best == nullptr) {
    result.status = UpdateStatus::no_model;
    result.message = "from no start could the model be fitted: " + solved.front().failure;
    result.model_evaluations = problem.evaluations();
    return result;
  }
  UpdateSolution answer = *best;
  UpdateProblem settled = take_segments_off(problem, options, answer);
  if (options.starts > 1 && is_misfit(settled, answer)) {
    look_wider(problem, options, answer, settled, count, result);
  }
  leave_out_contradictions(settled, options, answer);
  result.auto_segments = options.auto_segments;
  state_answer(settled, options, answer, result);
  for (int round = 0; round < kRefinements; ++round) {
    const auto& matches = answer.matches.matches;
    const int more = auto_segments_needed(settled, options, matches, result, result.auto_segments);
    if (more <= result.auto_segments) break;
    const UpdateProblem finer = settled.with_segment_errors().with_auto_segments(more);
    UpdateSolution trial = answer;
    double cost = 0;
    if (!minimise(finer, matches, UpdateStage::full, options, trial.q, cost)) break;
    answer = std::move(trial);
    settled = take_segments_off(finer, options, answer);
    result.auto_segments = more;
    state_answer(settled, options, answer, result);
  }
  for (int s = 0; s < static_cast<int>(problem.states().size()); ++s) {
    result.scenes.push_back(problem.scene_at(s, result.coordinates));
  }
  result.model_evaluations = problem.evaluations();
  if (result.message.ends_with("; ")) result.message.resize(result.message.size() - 2);
  return result;
}

UpdateResult update_model(const std::vector<UpdateState>& states,
                          const std::vector<FreeParameter>& free, const UpdateOptions& options) {
  return update_result(UpdateProblem(states, free, options), options);
}

PairedModes compare_with_measured(const std::vector<UpdateState>& states,
                                  const UpdateOptions& options) {
  const UpdateProblem problem(states, {}, options);
  PairedModes result;
  std::string failure;
  const auto matches = problem.match(Eigen::VectorXd(), 1, failure);
  if (!failure.empty()) return result;
  result.pairs = problem.pairs(Eigen::VectorXd(), matches.matches);
  result.unpaired = matches.unpaired;
  result.rms_relative_error = rms_of_pairs(result.pairs);
  return result;
}

}  // namespace rigfit::ident
