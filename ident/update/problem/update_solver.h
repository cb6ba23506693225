// The minimiser behind `update_model`: least squares with given pairs, by Ceres. For the update and
// its checks, not for users.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

struct UpdateSolution {
  Eigen::VectorXd q;  ///< empty: there is none, see `failure`
  UpdateMatches matches;
  double cost = std::numeric_limits<double>::infinity();
  bool converged = false;
  int pairings = 0;
  std::string failure;
};

/// Huber's rho as a change of the residual, r~ with r~^2 = rho(r^2), and d r~ / d r.
[[nodiscard]] double huber_residual(double r, double threshold, double& derivative);

/// With fixed pairs, from q, which becomes the answer. False when it did not converge. `held`: a
/// coordinate that stays as it is; -1: none.
[[nodiscard]] bool minimise(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                            const UpdateOptions& options, Eigen::VectorXd& q, double& cost,
                            int held = -1);

/// Half the sum of squares with Huber's rho; false when there is no model.
[[nodiscard]] bool robust_cost(const UpdateProblem& problem,
                               const std::vector<UpdateMatch>& matches,
                               const UpdateOptions& options, const Eigen::VectorXd& q,
                               double& cost);

/// What `update_model` gives for a problem that may hold a state out.
[[nodiscard]] UpdateResult update_result(const UpdateProblem& problem,
                                         const UpdateOptions& options);

}  // namespace rigfit::ident
