// The minimiser behind `update_model`: least squares with given pairs, by Ceres. For the update and
// its checks, not for users.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

/// An assignment of the modes, and the minimum with it.
struct UpdateAnswer {
  Eigen::VectorXd q = {};  ///< empty: there is none, see `failure`
  UpdateMatches matches = {};
  double cost = std::numeric_limits<double>::infinity();
  bool converged = false;
  std::string failure = {};
  double error = 0;  ///< tau of largest posterior probability (update_alternatives.h)
  double log_evidence = 0;
  Eigen::MatrixXd hessian = {};  ///< second derivatives of -ln(posterior), by coordinate
  double weight = 1;
};

/// With fixed pairs, from q, which becomes the answer, until the cost changes by less than
/// `tolerance` of it. False when it did not converge. `held`: a coordinate that stays as it is; -1:
/// none.
[[nodiscard]] bool minimise(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                            Eigen::VectorXd& q, double& cost, double tolerance = 1e-9,
                            int held = -1);

/// Half the sum of squares; false when there is no model.
[[nodiscard]] bool cost_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                           const Eigen::VectorXd& q, double& cost);

}  // namespace rigfit::ident
