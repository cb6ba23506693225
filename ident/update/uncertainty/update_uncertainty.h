// Covariance, budget and predictions of an update: how far the data's scatter, the priors, the
// inputs that were taken as known and the error of the segments reach (formulas in model_update.h).
// For the update and its checks, not for users.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

/// Ratio of singular values below which a direction counts as not determined.
inline constexpr double kRankTolerance = 1e-8;

/// Factors of the residuals' rows: Huber's weights of the data over the root of their variance
/// factor; one for priors.
[[nodiscard]] Eigen::VectorXd residual_weights(const UpdateProblem& problem,
                                               const UpdateOptions& options,
                                               const Eigen::VectorXd& r, double variance_factor);

/// Change of residuals by the error of the segments: 4/3 of the difference between n and 2 n of
/// them (Richardson). `value` gives what is compared of a problem; false without a model.
template <typename Value>
[[nodiscard]] bool change_by_segments(const UpdateProblem& problem, const Value& value,
                                      Eigen::VectorXd& change) {
  constexpr double kRichardson = 4.0 / 3;
  Eigen::VectorXd here, fine;
  if (!value(problem, here) ||
      !value(problem.with(&UpdateVariant::segment_factor, 2 * problem.variant().segment_factor),
             fine)) {
    return false;
  }
  change = kRichardson * (here - fine);
  return true;
}

/// Fills everything in `result` that is uncertain, from its coordinates. `by_segments`: how far the
/// segments move the coordinates, where that is known better than by a linear estimate; empty: by
/// that.
void state_uncertainty(const UpdateProblem& problem, const UpdateOptions& options,
                       const std::vector<UpdateMatch>& matches, UpdateResult& result,
                       const Eigen::VectorXd& by_segments = {});

/// Fills model_std_hz of pairs as modelled at `q`. `held_out`: a state whose own values are taken
/// as they are (where they have no prior); -1: none.
void state_prediction_uncertainty(const UpdateProblem& problem, const UpdateOptions& options,
                                  const UpdateResult& result, const Eigen::VectorXd& q,
                                  int held_out, std::vector<UpdatedPair>& pairs);

}  // namespace rigfit::ident
