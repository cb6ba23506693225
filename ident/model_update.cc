#include "ident/model_update.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ident/contradicting_modes.h"
#include "ident/update_problem.h"
#include "ident/update_solver.h"
#include "ident/update_uncertainty.h"
#include "signal/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;

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
  const auto best_of = [&solved] {
    const UpdateSolution* best = nullptr;
    for (const auto& one : solved) {
      if (one.q.size() > 0 && (best == nullptr || one.cost < best->cost)) best = &one;
    }
    return best;
  };
  const UpdateSolution* best = best_of();
  if (options.starts > 1 && best != nullptr && is_misfit(problem, *best)) {
    // Perhaps nothing but wrong pairs far from the truth: twice as many starts, ten times as far.
    // Taken when they explain the data, and no fewer of them.
    UpdateOptions wider = options;
    wider.start_spread = 10 * options.start_spread;
    wider.starts = 2 * options.starts + 1;
    ++wider.seed;
    const int unpaired = best->matches.unpaired_measured;
    for (auto& one : solve_from_all_starts(problem, wider)) {
      if (one.q.size() > 0 && one.matches.unpaired_measured <= unpaired &&
          !is_misfit(problem, one)) {
        solved.push_back(std::move(one));
      }
    }
    best = best_of();
  }
  for (const auto& one : solved) result.pairings += one.pairings;
  result.starts = static_cast<int>(solved.size());
  if (best == nullptr) {
    result.status = UpdateStatus::no_model;
    result.message = "from no start could the model be fitted: " + solved.front().failure;
    result.model_evaluations = problem.evaluations();
    return result;
  }
  UpdateSolution answer = *best;
  leave_out_contradictions(problem, options, answer);
  best = &answer;
  result.coordinates = best->q;
  for (const auto& one : solved) {
    // The same answer: a cost that differs by less than what a hundredth of a standard deviation
    // in one residual makes.
    result.starts_agreeing += one.q.size() > 0 && one.cost <= best->cost * (1 + 1e-4) + 1e-4;
  }
  for (std::size_t j = 0; j < coordinates.size(); ++j) {
    result.parameters[j].value = coordinates[j].value(best->q[static_cast<Eigen::Index>(j)]);
  }
  result.status = best->converged ? UpdateStatus::converged : UpdateStatus::not_converged;
  if (!best->converged) {
    result.message =
        "the fit or its pairs had not settled; what is given is the best that was "
        "seen; ";
  }
  if (static_cast<Eigen::Index>(coordinates.size()) >
      problem.residual_count(best->matches.matches, UpdateStage::full)) {
    result.status = UpdateStatus::too_little_data;
    result.message += fmt::format("{} unknowns and {} data; ", coordinates.size(),
                                  problem.residual_count(best->matches.matches, UpdateStage::full));
  }
  result.pairs = problem.pairs(best->q, best->matches.matches);
  result.unpaired = best->matches.unpaired;
  result.rms_relative_error = rms_of_pairs(result.pairs);
  if (problem.has_frfs()) {
    result.rms_log_frf_error = problem.rms_log_frf_error(best->q);
    result.frf_lines = problem.frf_lines();
  }
  if (problem.has_histories()) result.history_error = problem.history_error(best->q);
  state_uncertainty(problem, options, best->matches.matches, result);
  for (int s = 0; s < static_cast<int>(problem.states().size()); ++s) {
    result.scenes.push_back(problem.scene_at(s, best->q));
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
