#include "ident/update/uncertainty/update_segments.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace rigfit::ident {
namespace {

// Frequencies for vanishing segments: relative accuracy as a share of what they are known to.
constexpr double kShareOfStd = 0.1, kLeastAccuracy = 1e-6;
}  // namespace

bool UpdateProblem::is_resolved(int state) const {
  return variant_.segment_errors &&
         !(*variant_.segment_errors)[static_cast<std::size_t>(state)].empty();
}

UpdateProblem UpdateProblem::with_resolved_modes(const Eigen::VectorXd& q, bool given) const {
  UpdateProblem other = with(&UpdateVariant::segment_errors, nullptr);
  auto errors = std::make_shared<std::vector<std::vector<SegmentError>>>(states_.size());
  for (std::size_t s = 0; s < states_.size(); ++s) {
    const auto& state = states_[s];
    const int index = static_cast<int>(s);
    const model::Scene scene = scene_at(index, q);
    const bool open = given || std::all_of(scene.members.begin(), scene.members.end(),
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
                                UpdateSolution& answer) {
  constexpr int kPasses = 2;
  UpdateProblem settled = problem;
  if (!options.segment_uncertainty || !problem.has_modes()) return settled;
  for (int pass = 0; pass < kPasses; ++pass) {
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

UpdateProblem with_resolving_segments(const UpdateProblem& problem,
                                      const std::vector<UpdateMatch>& matches,
                                      const Eigen::VectorXd& q) {
  constexpr double kSmall = 0.1, kMostTimes = 8;
  UpdateProblem settled = problem;
  for (const auto& state : problem.states()) {
    for (const auto& member : state.scene.members) {
      if (member.segments != 0) return settled;
    }
  }
  for (double factor = 2; factor <= kMostTimes; factor *= 2) {
    UpdateProblem finer = problem.with(&UpdateVariant::segment_factor, factor);
    Eigen::VectorXd here, fine;
    if (!settled.residuals(q, matches, here, nullptr) ||
        !finer.residuals(q, matches, fine, nullptr) || (here - fine).squaredNorm() < kSmall) {
      break;
    }
    settled = std::move(finer);
  }
  return settled;
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
