#include "ident/model_update.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ident/contradicting_modes.h"
#include "ident/update_problem.h"
#include "ident/update_solver.h"
#include "signal/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;

// Weighted Jacobian at the solution, Huber's weights included; the priors' rows last.
bool weighted(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
              const UpdateOptions& options, const Eigen::VectorXd& q, Eigen::VectorXd& r,
              Eigen::MatrixXd& J) {
  if (!problem.residuals(q, matches, UpdateStage::full, r, &J)) return false;
  for (Eigen::Index i = 0; i < r.size() - problem.prior_count(); ++i) {
    const double weight =
        std::min(1.0, std::sqrt(options.huber_threshold / std::max(std::abs(r[i]), 1e-300)));
    r[i] *= weight;
    J.row(i) *= weight;
  }
  return true;
}

void state_uncertainty(const UpdateProblem& problem, const UpdateOptions& options,
                       UpdateResult& result, const std::vector<UpdateMatch>& matches) {
  const Eigen::Index n = problem.size();
  const Eigen::VectorXd& q = result.coordinates;
  Eigen::VectorXd r;
  Eigen::MatrixXd J;
  result.covariance = Eigen::MatrixXd::Constant(n, n, kNaN);
  if (!weighted(problem, matches, options, q, r, J)) return;
  const Eigen::Index data = r.size() - problem.prior_count();
  result.chi_squared = r.squaredNorm();
  result.degrees_of_freedom = static_cast<double>(r.size() - n) - problem.shared_residuals();
  const double reduced =
      result.degrees_of_freedom > 0 ? result.chi_squared / result.degrees_of_freedom : kNaN;
  // Stated uncertainties are trusted unless the scatter contradicts them; assumed ones are not.
  const bool stated = problem.uncertainties_known();
  if (stated) {
    result.variance_factor = reduced > 1 ? reduced : 1;
    if (reduced > 9) {
      result.message += fmt::format(
          "the misfit is {:.1f} times what the stated uncertainties allow: the model, a pair or an "
          "uncertainty is wrong; ",
          std::sqrt(reduced));
    }
  } else {
    result.variance_factor = std::isfinite(reduced) ? reduced : 1;
  }
  const bool from_scatter = !stated && std::isfinite(reduced);
  result.coverage_factor = coverage_factor(0.95, from_scatter ? result.degrees_of_freedom : 0);
  if (!stated && !std::isfinite(reduced)) {
    result.message +=
        "no more data than unknowns: uncertainties rest on the assumed one of the "
        "frequencies; ";
  }

  Eigen::VectorXd scales = Eigen::VectorXd::Ones(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    if (!problem.coordinates()[static_cast<std::size_t>(j)].logarithmic) {
      scales[j] = std::max(1.0, std::abs(q[j]));
    }
  }
  IdentifiabilityOptions limits;
  limits.relative_rank_tolerance = 1e-8;
  limits.variance_factor = std::max(result.variance_factor, 1e-12);
  const auto names = problem.names();
  result.identifiability = identifiability(J, scales, names, limits);
  const auto alone = identifiability(J.topRows(data), scales, names, limits);
  for (const auto& open : result.identifiability.open) result.open.push_back(open.message);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(i)];
    auto& parameter = result.parameters[static_cast<std::size_t>(i)];
    const double by = coordinate.derivative(q[i]);
    parameter.identifiable = result.identifiability.identifiable[static_cast<std::size_t>(i)];
    parameter.std = std::abs(by) * result.identifiability.std[i];
    parameter.std_from_data = std::abs(by) * alone.std[i];
    parameter.at_bound = q[i] <= coordinate.low + 1e-9 || q[i] >= coordinate.high - 1e-9;
    for (Eigen::Index j = 0; j < n; ++j) {
      result.covariance(i, j) = by * result.identifiability.covariance(i, j) *
                                problem.coordinates()[static_cast<std::size_t>(j)].derivative(q[j]);
    }
  }
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
  state_uncertainty(problem, options, result, best->matches.matches);
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
