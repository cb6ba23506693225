#include "ident/update/frfs/frf_segments.h"

#include <utility>

#include "ident/update/uncertainty/shared_sources.h"
#include "ident/update/uncertainty/update_misfit.h"
#include "ident/update/uncertainty/update_segments.h"
#include "ident/update/uncertainty/update_uncertainty.h"

namespace rigfit::ident {

void allow_for_shared(const UpdateOptions& options, UpdateProblem& settled, UpdateSolution& answer,
                      UpdateResult& result) {
  if (!settled.has_frfs()) return;
  settled = settled.with_frf_model_std(0).with_frf_differences();
  const auto& matches = answer.matches.matches;
  const auto again = [&](const UpdateProblem& trial) {
    Eigen::VectorXd q = answer.q;
    double cost = 0;
    const bool converged = minimise(trial, matches, UpdateStage::full, options, q, cost);
    if (!converged && !robust_cost(trial, matches, UpdateStage::full, options, q, cost)) return;
    answer.q = std::move(q);
    answer.cost = cost;
    answer.converged = converged;
    settled = trial;
  };
  if (settled.inputs().size() == options.inputs.size()) {
    settled = settled.with_places_of_hits(answer.q);
  }
  constexpr int kPasses = 6;
  for (int pass = 0; pass < kPasses; ++pass) {
    const Eigen::VectorXd before = answer.q, off = settled.inputs_off();
    again(with_shared_sources(settled, matches, answer.q));
    if (!settled.has_sources()) break;
    if ((answer.q - before).norm() < 1e-6 && (settled.inputs_off() - off).norm() < 1e-3) break;
  }
  const UpdateFit fit = misfit_of(settled, matches, answer.q);
  if (!(fit.p_value < kUnlikelyMisfit) || !fit.stated) return;
  const double tau = frf_model_std_of(settled, matches, answer.q);
  if (!(tau > 0)) return;
  result.fit = fit;
  result.fit.frf_model_std = tau;
  again(with_shared_sources(settled.with_frf_model_std(tau), matches, answer.q));
}

std::optional<ResolvedFit> with_resolving_segments(const UpdateProblem& settled,
                                                   const UpdateOptions& options,
                                                   const UpdateSolution& answer,
                                                   UpdateResult result) {
  constexpr int kMostTimes = 8;
  if (!options.segment_uncertainty || !settled.has_frfs() || !settled.has_given_segments()) {
    return std::nullopt;
  }
  const auto& matches = answer.matches.matches;
  ResolvedFit fine{settled, answer, {}, {}};
  for (int factor = 2; factor <= kMostTimes; factor *= 2) {
    if (!(segment_excess(fine.problem, matches, result) > 1)) break;
    UpdateProblem finer = settled.with_segments(factor).with_frf_model_std(0).with_sources(nullptr);
    UpdateSolution trial = fine.answer;
    trial.converged = minimise(finer, matches, UpdateStage::full, options, trial.q, trial.cost);
    if (!trial.converged) break;
    result.fit = {};
    allow_for_shared(options, finer, trial, result);
    fine.fit = result.fit;
    result.coordinates = trial.q;
    for (auto& parameter : result.parameters) parameter.budget.clear();
    result.fit = misfit_of(finer, matches, trial.q);
    result.fit.frf_model_std = fine.fit.frf_model_std;
    state_uncertainty(finer, options, matches, result);
    fine.problem = std::move(finer);
    fine.answer = std::move(trial);
  }
  if (fine.problem.segment_factor() == settled.segment_factor()) return std::nullopt;
  fine.by_segments = answer.q - fine.answer.q;
  if (!result.shift_sources.empty() && result.shift_sources.front() == "segments") {
    fine.by_segments += result.shifts.col(0);
  }
  return fine;
}

}  // namespace rigfit::ident
