#include "ident/update/model_update.h"

#include <fmt/format.h>

#include "ident/update/assignment/update_alternatives.h"
#include "ident/update/problem/update_problem.h"
#include "ident/update/uncertainty/update_uncertainty.h"

namespace rigfit::ident {
namespace {

// The answer's values, and its pairs.
void state_values(const UpdateProblem& problem, const UpdateAnswer& answer, UpdateResult& result) {
  const auto& coordinates = problem.coordinates();
  result.coordinates = answer.q;
  for (std::size_t j = 0; j < result.parameters.size(); ++j) {
    result.parameters[j].value = coordinates[j].value(answer.q[static_cast<Index>(j)]);
  }
  result.pairs = problem.pairs(answer.q, answer.matches.matches);
  result.unpaired = answer.matches.unpaired;
  result.rms_relative_error = rms_of_pairs(result.pairs);
  for (const auto& pair : result.pairs) {
    if (pair.cross_plane || !problem.modes_only()) continue;
    result.fit.rms_error = result.rms_relative_error;
    result.fit.worst_error = std::max(result.fit.worst_error, std::abs(pair.relative_error));
  }
  if (problem.has_frfs()) {
    result.rms_log_frf_error = problem.rms_log_frf_error(answer.q);
    result.frf_lines = problem.frf_lines();
  }
}

// Everything in the result that follows from the answer.
void state_answer(const UpdateProblem& problem, const UpdateAnswer& answer, UpdateResult& result) {
  const auto& matches = answer.matches.matches;
  result.status = answer.converged ? UpdateStatus::converged : UpdateStatus::not_converged;
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
  state_uncertainty(problem, matches, result);
  state_intervals(problem, matches, result);
}

// Moves the answer, pairs kept, to the minimum of `trial`, which `problem` becomes; neither moves
// where no minimum is found.
bool move_to(UpdateProblem trial, UpdateProblem& problem, UpdateAnswer& answer) {
  VectorXd q = answer.q;
  double cost = 0;
  if (!minimise(trial, answer.matches.matches, q, cost)) return false;
  answer.q = std::move(q);
  problem = std::move(trial);
  return true;
}

// The minimum without an error of the model (the search allows for one), with noisy lines of FRFs
// by their difference and the error of "auto" segments taken off, anew as the parameters move;
// then, where its misfit asks for it, the minimum with an error of the model.
UpdateFit settle(UpdateProblem& problem, UpdateAnswer& answer) {
  constexpr int kPasses = 8;
  const auto& matches = answer.matches.matches;
  // What the search left is no minimum of this problem.
  if (!move_to(problem.with(&UpdateVariant::frf_differences, true), problem, answer)) {
    answer.converged = false;
  }
  for (int pass = 0; pass < kPasses && problem.options().segment_uncertainty; ++pass) {
    UpdateProblem resolved = problem.with_resolved_modes(answer.q);
    if (!resolved.variant().segment_errors || problem.resolved_as(resolved, matches, answer.q))
      break;
    // Where no minimum is found, as in a flat valley, the segments' error is no misfit either.
    double cost = 0;
    answer.converged = minimise(resolved, matches, answer.q, cost) && answer.converged;
    problem = std::move(resolved);
  }
  UpdateFit fit = misfit_of(problem, matches, answer.q);
  if (!(fit.p_value < kUnlikelyMisfit) || (problem.has_frfs() && !fit.stated)) return fit;
  const double tau = model_std_of(problem, matches, answer.q);
  if (!(tau > 0)) return fit;
  auto& allowed = problem.has_frfs() ? fit.frf_model_std : fit.model_std;
  if (move_to(problem.has_frfs() ? problem.with(&UpdateVariant::frf_model_std, tau)
                                 : problem.with_model_std(tau),
              problem, answer)) {
    allowed = tau;
  }
  return fit;
}

// The prediction of a state from the fit of the others, whose minimum is sought from that of all,
// so that the pairs stay; its own parameters stay as they were known before. `problem` and `answer`
// as settled with the state in.
HeldOut hold_out(const UpdateProblem& problem, const UpdateAnswer& answer,
                 const UpdateResult& result, int s) {
  HeldOut held;
  held.state = s;
  held.name = problem.state_at(s).name;
  UpdateProblem others = problem.with(&UpdateVariant::held_out, s);
  const UpdateProblem alone = problem.with(&UpdateVariant::only, s);
  UpdateAnswer rest = answer;
  std::erase_if(rest.matches.matches, [&](const auto& match) { return match.state == s; });
  held.status =
      move_to(others, others, rest) ? UpdateStatus::converged : UpdateStatus::not_converged;
  for (Index j = 0; j < problem.size(); ++j) {
    const auto& coordinate = problem.coordinate_at(j);
    if (coordinate.state == s) rest.q[j] = coordinate.start;
  }
  held.rms_fitted = rms_of_pairs(others.pairs(rest.q, rest.matches.matches));
  held.scene = problem.scene_at(s, rest.q);
  std::vector<UpdatedPair> before = result.pairs_before;
  std::erase_if(before, [&](const auto& pair) { return pair.state != s; });
  held.rms_before = rms_of_pairs(before);
  if (problem.has_frfs()) {
    const VectorXd start = problem.start();
    held.frf_before = alone.rms_log_frf_error(start);
    held.frf_fitted = others.rms_log_frf_error(rest.q);
    held.frf_predicted = alone.rms_log_frf_error(rest.q);
  }
  std::string failure;
  const auto found = alone.match(rest.q, failure);
  held.pairs = problem.pairs(rest.q, found.matches);
  held.rms_predicted = rms_of_pairs(held.pairs);
  UpdateResult fit;
  fit.parameters.resize(result.parameters.size());
  fit.fit = result.fit;
  fit.coordinates = rest.q;
  state_uncertainty(others, rest.matches.matches, fit);
  state_prediction_uncertainty(problem, fit, rest.q, s, held.pairs);
  return held;
}

// Fits to modes: all answers. Fits of FRFs: the best that begins with one of their modes' answers,
// or where the scene is; `problem` becomes the one whose segments resolve them.
std::vector<UpdateAnswer> answers_of(UpdateProblem& problem, UpdateResult& result,
                                     std::string& failure) {
  std::vector<UpdateAnswer> answers;
  if (problem.has_modes()) {
    answers = find_answers(problem.modes_alone(), result.starts, failure);
  } else if (problem.has_frfs()) {
    answers.resize(1);
    answers.front().q = problem.start();
    result.starts = 1;
  } else {
    failure = "no mode and no FRF was measured";
  }
  if (answers.empty() || problem.modes_only()) return answers;
  if (problem.options().segment_uncertainty) {
    const auto& first = answers.front();
    problem = problem.with_resolving_segments(first.matches.matches, first.q);
  }
  UpdateAnswer best;
  for (auto& answer : answers) {
    answer.converged = minimise(problem, answer.matches.matches, answer.q, answer.cost);
    if (cost_of(problem, answer.matches.matches, answer.q, answer.cost) &&
        answer.cost < best.cost) {
      best = answer;
    }
  }
  failure = "no response of the model there";
  return best.q.size() > 0 ? std::vector<UpdateAnswer>{best} : std::vector<UpdateAnswer>{};
}

struct SettledAnswer {
  UpdateProblem problem;  ///< with its nuisances, at its minimum
  UpdateAnswer answer;
  UpdateFit fit;
};

/// The answers at the minima of their likelihoods, heaviest first: their evidence is there.
std::vector<SettledAnswer> settled_answers(const UpdateProblem& problem,
                                           const std::vector<UpdateAnswer>& answers,
                                           UpdateResult& result) {
  std::vector<SettledAnswer> settled;
  for (auto answer : answers) {
    UpdateProblem whole = problem.with_hits(answer.q);
    const UpdateFit fit = settle(whole, answer);
    // Where the model cannot be solved the evidence of the search stands.
    if (problem.modes_only()) (void)weigh(whole, answer);
    settled.push_back({std::move(whole), std::move(answer), fit});
  }
  if (!problem.modes_only()) return settled;
  std::ranges::stable_sort(settled, std::greater{},
                           [](const auto& one) { return one.answer.log_evidence; });
  double all = 0;
  const double most = settled.front().answer.log_evidence;
  for (const auto& one : settled) all += std::exp(one.answer.log_evidence - most);
  for (auto& one : settled) one.answer.weight = std::exp(one.answer.log_evidence - most) / all;
  result.log_evidence = most + std::log(all);
  return settled;
}

/// A fit with the error of the scenes' own segments taken off says what they shift.
void state_segment_shifts(const UpdateProblem& settled, const UpdateAnswer& answer,
                          UpdateResult& result) {
  const auto& states = settled.states();
  const bool given = std::ranges::any_of(states, [](const UpdateState& state) {
    return std::ranges::any_of(
        state.scene.members, [](int n) { return n != 0; }, &model::Member::segments);
  });
  if (!given || !settled.options().segment_uncertainty || !settled.modes_only()) return;
  UpdateProblem resolved = settled.with_resolved_modes(answer.q, true);
  UpdateAnswer there = answer;
  if (!move_to(resolved, resolved, there)) return;
  for (std::size_t j = 0; j < result.parameters.size(); ++j) {
    auto& parameter = result.parameters[j];
    parameter.segment_shift =
        parameter.value - settled.coordinates()[j].value(there.q[static_cast<Index>(j)]);
  }
}

}  // namespace

const char* name_of(UpdateStatus status) {
  constexpr std::array names{"converged", "not converged", "no model", "too little data"};
  return names[static_cast<std::size_t>(status)];
}

UpdateResult update_model(const std::vector<UpdateState>& states,
                          const std::vector<FreeParameter>& free, const UpdateOptions& options) {
  UpdateProblem problem(states, free, options);
  UpdateResult result;
  const auto& coordinates = problem.coordinates();
  if (free.empty()) throw std::invalid_argument("update: no free parameter");
  const VectorXd start = problem.start();
  const auto names = problem.names();
  for (std::size_t j = 0; j < static_cast<std::size_t>(problem.parameter_count()); ++j) {
    const double value = coordinates[j].value(start[static_cast<Index>(j)]);
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

  const std::vector<UpdateAnswer> answers = answers_of(problem, result, failure);
  if (answers.empty()) {
    result.status = UpdateStatus::no_model;
    result.message =
        "Check the scene and the bounds: from no start could the model be fitted, " + failure;
    return result;
  }
  std::vector<SettledAnswer> settled = settled_answers(problem, answers, result);
  std::vector<UpdateAlternative> alternatives;
  const UpdateResult plain = result;
  for (auto& [whole, answer, fit] : settled) {  // each with its own uncertainty
    UpdateResult other = plain;
    other.fit = fit;
    state_answer(whole, answer, other);
    alternatives.push_back(
        {answer.matches, other, answer.weight, answer.log_evidence, fit.model_std});
    if (alternatives.size() > 1) continue;
    state_segment_shifts(whole, answer, other);
    for (int s = 0; s < static_cast<int>(states.size()); ++s) {
      other.scenes.push_back(whole.scene_at(s, answer.q));
      if (!options.hold_out || states.size() < 2) continue;
      other.held.push_back(hold_out(whole, answer, other, s));
    }
    result = std::move(other);
    if (!problem.modes_only()) break;
  }
  std::vector<UpdatedPair> held;
  for (const auto& one : result.held) held.insert(held.end(), one.pairs.begin(), one.pairs.end());
  result.rms_held_out = rms_of_pairs(held);
  if (problem.modes_only()) result.alternatives = std::move(alternatives);
  if (result.alternatives.size() > 1) state_mixture(result);
  if (result.message.ends_with("; ")) result.message.resize(result.message.size() - 2);
  return result;
}

}  // namespace rigfit::ident
