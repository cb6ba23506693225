// Covariance, budget and predictions of an update: how far the data's scatter, the priors, the
// inputs that were taken as known and the error of the segments reach (formulas in model_update.h).
// For the update and its checks, not for users.
#pragma once

#include <vector>

#include "ident/update/update_problem.h"

namespace rigfit::ident {

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
