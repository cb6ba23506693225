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
  std::string failure;
};

/// With fixed pairs, from q, which becomes the answer. False when it did not converge. `held`: a
/// coordinate that stays as it is; -1: none.
[[nodiscard]] bool minimise(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                            const UpdateOptions& options, Eigen::VectorXd& q, double& cost,
                            int held = -1);

/// Half the sum of squares; false when there is no model.
[[nodiscard]] bool cost_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                           const Eigen::VectorXd& q, double& cost);

}  // namespace rigfit::ident
