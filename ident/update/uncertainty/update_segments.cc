#include "ident/update/uncertainty/update_segments.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "ident/update/uncertainty/update_misfit.h"
#include "ident/update/uncertainty/update_uncertainty.h"

namespace rigfit::ident {
namespace {

// Frequencies for vanishing segments: relative accuracy as a share of what they are known to.
constexpr double kShareOfStd = 0.1, kLeastAccuracy = 1e-6;
// Shift of a parameter by segments over its standard uncertainty from all else that is small
// enough.
constexpr double kSmall = 0.2;

// How many times too large the segments' error in FRFs is, as a ratio of h^2; `result`: stated with
// `problem`.
double segment_excess(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                      const UpdateResult& result) {
  double excess = 0;
  for (const auto& parameter : result.parameters) {
    if (!parameter.identifiable || !std::isfinite(parameter.segment_shift)) continue;
    const double all = parameter.std * parameter.std,
                 own = parameter.segment_shift * parameter.segment_shift;
    const double small = kSmall * std::sqrt(std::max(all - own, 1e-6 * own));
    if (own > 0) excess = std::max(excess, std::sqrt(own) / small);
  }
  Eigen::VectorXd change;
  const auto residuals = [&](const UpdateProblem& moved, Eigen::VectorXd& r) {
    return moved.residuals(result.coordinates, matches, r, nullptr);
  };
  if (!change_by_segments(problem, residuals, change)) return excess;
  const double verdict = kSmall * std::sqrt(2 * std::max(1.0, result.degrees_of_freedom));
  return std::max(excess, std::sqrt(change.squaredNorm() / verdict));
}

}  // namespace

bool UpdateProblem::has_given_segments() const {
  return std::any_of(states_.begin(), states_.end(), [](const auto& state) {
    return std::any_of(state.scene.members.begin(), state.scene.members.end(),
                       [](const auto& member) { return member.segments != 0; });
  });
}

bool UpdateProblem::is_resolved(int state) const {
  return variant_.segment_errors &&
         !(*variant_.segment_errors)[static_cast<std::size_t>(state)].empty();
}

UpdateProblem UpdateProblem::with_resolved_modes(const Eigen::VectorXd& q) const {
  UpdateProblem other = with(&UpdateVariant::segment_errors, nullptr);
  auto errors = std::make_shared<std::vector<std::vector<SegmentError>>>(states_.size());
  for (std::size_t s = 0; s < states_.size(); ++s) {
    const auto& state = states_[s];
    const int index = static_cast<int>(s);
    const model::Scene scene = scene_at(index, q);
    const bool open = std::all_of(scene.members.begin(), scene.members.end(),
                                  [](const auto& member) { return member.segments == 0; });
    if (state.measured.empty() || state.modes_lead_only || !open) continue;
    double accuracy = scene.accuracy;
    for (std::size_t m = 0; m < state.measured.size(); ++m) {
      accuracy = std::min(accuracy, kShareOfStd * relative_std(index, static_cast<int>(m)));
    }
    model::ModesOptions asked;
    asked.count = mode_count(index);
    asked.shapes = asked.error_estimate = false;
    asked.accuracy = std::max(accuracy, kLeastAccuracy);
    const auto here = other.modes(index, q, false);
    const auto limit = model::analyse_modes(scene, asked);
    if (!here.failure.empty() || !limit.extrapolated) continue;
    std::map<model::ModePlane, int> seen;
    for (const auto& natural : limit.modes) {
      const int order = seen[natural.plane]++;
      const auto* mode = here.find(natural.plane, order);
      if (mode == nullptr || !known(natural.frequency_hz)) continue;
      (*errors)[s].push_back(
          {natural.plane, order, std::log(mode->frequency_hz / natural.frequency_hz)});
    }
  }
  other.variant_.segment_errors = std::move(errors);
  return other;
}

UpdateProblem take_segments_off(const UpdateProblem& problem, const UpdateOptions& options,
                                UpdateSolution& answer, int passes) {
  UpdateProblem settled = problem;
  if (!options.segment_uncertainty || !problem.has_modes()) return settled;
  for (int pass = 0; pass < passes; ++pass) {
    UpdateProblem trial = problem.with_resolved_modes(answer.q);
    const auto& errors = *trial.variant().segment_errors;
    if (std::all_of(errors.begin(), errors.end(), [](const auto& of) { return of.empty(); })) break;
    Eigen::VectorXd q = answer.q;
    double cost = 0;
    if (!minimise(trial, answer.matches.matches, options, q, cost)) break;
    answer.q = std::move(q);
    settled = std::move(trial);
  }
  return settled;
}

std::optional<ResolvedFit> with_resolving_segments(const UpdateProblem& settled,
                                                   const UpdateOptions& options,
                                                   const UpdateSolution& answer,
                                                   UpdateResult result) {
  constexpr int kMostTimes = 8;
  if (!options.segment_uncertainty || !settled.has_frfs()) return std::nullopt;
  const auto& matches = answer.matches.matches;
  ResolvedFit fine{settled, answer, {}, {}};
  for (int factor = 2; factor <= kMostTimes; factor *= 2) {
    if (!(segment_excess(fine.problem, matches, result) > 1)) break;
    UpdateProblem finer =
        settled.with(&UpdateVariant::segment_factor, factor).with(&UpdateVariant::frf_model_std, 0);
    UpdateSolution trial = fine.answer;
    trial.converged = false;
    result.fit = {};
    settle_frfs(options, finer, trial, result);
    if (!trial.converged) break;
    fine.fit = result.fit;
    result.coordinates = trial.q;
    for (auto& parameter : result.parameters) parameter.budget.clear();
    result.fit = misfit_of(finer, matches, trial.q);
    result.fit.frf_model_std = fine.fit.frf_model_std;
    state_uncertainty(finer, options, matches, result);
    fine.problem = std::move(finer);
    fine.answer = std::move(trial);
  }
  if (fine.problem.variant().segment_factor == settled.variant().segment_factor) {
    return std::nullopt;
  }
  fine.by_segments = answer.q - fine.answer.q;
  if (result.by_segments.size() > 0) fine.by_segments += result.by_segments;
  return fine;
}

UpdateProblem as_solved(const UpdateProblem& problem, const UpdateOptions& options,
                        const UpdateResult& solution, const Eigen::VectorXd& q) {
  Eigen::VectorXd parameters = q.head(problem.parameter_count());
  const UpdateProblem same = problem.with_nuisances(parameters)
                                 .with(&UpdateVariant::segment_factor, solution.segment_factor)
                                 .with_model_std(solution.fit.model_std);
  return options.segment_uncertainty ? same.with_resolved_modes(q) : same;
}

}  // namespace rigfit::ident
