#include "ident/update/update_checks.h"

#include "ident/statistics/in_parallel.h"
#include "ident/update/problem/update_solver.h"
#include "ident/update/uncertainty/update_segments.h"
#include "ident/update/uncertainty/update_uncertainty.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
using signal::kNaN;

std::vector<HeldOut> hold_out_each(const std::vector<UpdateState>& states,
                                   const std::vector<FreeParameter>& free,
                                   const UpdateOptions& given) {
  UpdateOptions options = given;
  options.intervals = false;  // the prediction needs the covariance alone
  std::vector<HeldOut> result(states.size());
  in_parallel(states.size(), options.threads, [&](std::size_t index) {
    const int s = static_cast<int>(index);
    HeldOut& held = result[index];
    held.state = s;
    held.name = states[index].name;
    held.rms_fitted = held.rms_predicted = held.rms_before = kNaN;
    held.frf_fitted = held.frf_predicted = held.frf_before = kNaN;
    const UpdateProblem problem(states, free, options, s);
    const UpdateResult fitted = update_result(problem, options);
    held.status = fitted.status;
    std::string failure;
    const auto before = problem.match(problem.start(), failure, s);
    if (failure.empty())
      held.rms_before = rms_of_pairs(problem.pairs(problem.start(), before.matches));
    if (problem.has_frfs()) held.frf_before = problem.rms_log_frf_error(problem.start(), s);
    if (fitted.coordinates.size() > 0) {
      held.frf_fitted = fitted.rms_log_frf_error;
      held.rms_fitted = fitted.rms_relative_error;
      // Its own values, where a parameter has one a state, stay as they were known before.
      Eigen::VectorXd q = fitted.coordinates;
      for (Eigen::Index j = 0; j < problem.size(); ++j) {
        const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
        if (coordinate.state == s) q[j] = coordinate.start;
      }
      const UpdateProblem solved = as_solved(problem, options, fitted, q);
      held.scene = solved.scene_at(s, q);
      if (problem.has_frfs()) held.frf_predicted = solved.rms_log_frf_error(q, s);
      failure.clear();
      const auto after = solved.match(q, failure, s);
      if (failure.empty()) {
        held.pairs = solved.pairs(q, after.matches);
        held.rms_predicted = rms_of_pairs(held.pairs);
        state_prediction_uncertainty(solved, fitted, q, s, held.pairs);
      }
    }
  });
  return result;
}

}  // namespace rigfit::ident
