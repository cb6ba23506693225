// Covariance, budget and predictions of an update: how far the data's scatter, the priors and the
// inputs that were taken as known reach (formulas in model_update.h). For the update and its
// checks, not for users.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

/// Ratio of singular values below which a direction counts as not determined.
inline constexpr double kRankTolerance = 1e-8;

/// Fills everything in `result` that is uncertain, from its coordinates.
void state_uncertainty(const UpdateProblem& problem, const UpdateOptions& options,
                       const std::vector<UpdateMatch>& matches, UpdateResult& result);

/// Fills model_std_hz of pairs as modelled at `q`. `held_out`: a state whose own values are taken
/// as they are (where they have no prior); -1: none.
void state_prediction_uncertainty(const UpdateProblem& problem, const UpdateResult& result,
                                  const Eigen::VectorXd& q, int held_out,
                                  std::vector<UpdatedPair>& pairs);

}  // namespace rigfit::ident
