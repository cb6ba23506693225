#include "ident/update/problem/update_solver.h"

#include <ceres/cost_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace rigfit::ident {

double huber_residual(double r, double k, double& derivative) {
  if (std::abs(r) <= k) {
    derivative = 1;
    return r;
  }
  const double root = std::sqrt(2 * k * std::abs(r) - k * k);
  derivative = k / root;
  return std::copysign(root, r);
}

namespace {

class UpdateCost : public ceres::CostFunction {
 public:
  UpdateCost(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
             double threshold)
      : problem_(problem), matches_(matches), threshold_(threshold) {
    set_num_residuals(static_cast<int>(problem.residual_count(matches)));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.size()));
  }
  bool Evaluate(double const* const* blocks, double* out, double** jacobians) const override {
    const bool derivatives = jacobians != nullptr && jacobians[0] != nullptr;
    const auto& coordinates = problem_.coordinates();
    Eigen::VectorXd q(problem_.size());
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      q[j] = coordinates[static_cast<std::size_t>(j)].from_step(blocks[0][j]);
    }
    // Most steps are taken: the Jacobian found with the residuals of a trial serves when it is
    // asked for.
    if (q_.size() == 0 || q != q_) {
      q_.resize(0);
      if (!problem_.residuals(q, matches_, r_, &J_)) return false;
      q_ = q;
    }
    const Eigen::VectorXd& r = r_;
    const Eigen::MatrixXd& J = J_;
    const Eigen::Index data = r.size() - problem_.prior_count();
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      double factor = 1;
      out[i] = i < data ? huber_residual(r[i], threshold_, factor) : r[i];
      if (!derivatives) continue;
      for (Eigen::Index j = 0; j < J.cols(); ++j) {
        const auto& coordinate = coordinates[static_cast<std::size_t>(j)];
        jacobians[0][i * J.cols() + j] =
            factor * J(i, j) * coordinate.step_derivative(blocks[0][j]);
      }
    }
    return true;
  }

  // Coordinates that stay where they are: `held`, and those that the slope presses on a bound.
  std::optional<std::vector<int>> pressed(const Eigen::VectorXd& u, int held) const {
    std::vector<int> found;
    Eigen::VectorXd slope;
    for (int j = 0; j < static_cast<int>(u.size()); ++j) {
      if (j == held) found.push_back(j);
      const auto [low, high] = problem_.coordinates()[static_cast<std::size_t>(j)].step_bounds();
      if (j == held || (u[j] > low && u[j] < high)) continue;
      if (slope.size() == 0 && !slope_at(u, slope)) return std::nullopt;
      if (u[j] <= low ? slope[j] >= 0 : slope[j] <= 0) found.push_back(j);
    }
    return found;
  }

 private:
  bool slope_at(const Eigen::VectorXd& u, Eigen::VectorXd& slope) const {
    Eigen::VectorXd r(num_residuals());
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> J(r.size(), u.size());
    const double* const at = u.data();
    double* jacobian = J.data();
    if (!Evaluate(&at, r.data(), &jacobian)) return false;
    slope = J.transpose() * r;
    return true;
  }

  const UpdateProblem& problem_;
  const std::vector<UpdateMatch>& matches_;
  double threshold_;
  mutable Eigen::VectorXd q_, r_;  // the last point; of one solver, on its thread
  mutable Eigen::MatrixXd J_;
};

// Stops where a coordinate has come to its bound.
class StopAtBounds : public ceres::IterationCallback {
 public:
  StopAtBounds(const UpdateProblem& problem, const Eigen::VectorXd& u, std::vector<int> pressed)
      : problem_(problem), u_(u), pressed_(std::move(pressed)) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (summary.iteration == 0 || !summary.step_is_successful) return ceres::SOLVER_CONTINUE;
    for (int j = 0; j < static_cast<int>(u_.size()); ++j) {
      const auto [low, high] = problem_.coordinates()[static_cast<std::size_t>(j)].step_bounds();
      const bool known = std::find(pressed_.begin(), pressed_.end(), j) != pressed_.end();
      if (!known && (u_[j] <= low || u_[j] >= high)) return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    }
    return ceres::SOLVER_CONTINUE;
  }

 private:
  const UpdateProblem& problem_;
  const Eigen::VectorXd& u_;
  std::vector<int> pressed_;
};

// Ceres keeps bounds by projecting its steps: one coordinate at its bound spoils the steps of the
// others, and the fit creeps. Those that the slope presses on a bound are held there instead (an
// active set: Nocedal and Wright, Numerical Optimization, 16.5), until it no longer does. False
// where no cost is found.
bool solve_within_bounds(UpdateCost& function, const UpdateProblem& problem,
                         const UpdateOptions& options, int held, Eigen::VectorXd& u, double& cost,
                         bool& converged) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.logging_type = ceres::SILENT;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.parameter_tolerance = 1e-9;
  solver.gradient_tolerance = 1e-9;
  // What the pairs leave open would otherwise run off along its valley.
  solver.min_lm_diagonal = 1e-4;
  // Valleys of tension and springs are curved: the first steps that the default of 1e4 allows fail.
  solver.initial_trust_region_radius = 100;
  solver.max_num_line_search_step_size_iterations = 0;
  solver.update_state_every_iteration = true;
  const int n = static_cast<int>(u.size());
  std::vector<int> pressed;
  ceres::Solver::Summary summary;
  for (int round = 0; round < options.max_iterations; ++round) {
    auto now = function.pressed(u, held);
    if (!now) return false;
    if (round > 0 && summary.termination_type != ceres::USER_SUCCESS && *now == pressed) break;
    pressed = std::move(*now);
    ceres::Problem::Options ownership;
    ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem ceres_problem(ownership);
    ceres_problem.AddResidualBlock(&function, nullptr, u.data());
    for (int j = 0; j < n; ++j) {
      const auto [low, high] = problem.coordinates()[static_cast<std::size_t>(j)].step_bounds();
      if (std::isfinite(low)) ceres_problem.SetParameterLowerBound(u.data(), j, low);
      if (std::isfinite(high)) ceres_problem.SetParameterUpperBound(u.data(), j, high);
    }
    if (static_cast<int>(pressed.size()) == n) {
      ceres_problem.SetParameterBlockConstant(u.data());
    } else if (!pressed.empty()) {
      ceres_problem.SetManifold(u.data(), new ceres::SubsetManifold(n, pressed));
    }
    StopAtBounds stop(problem, u, pressed);
    solver.callbacks = {&stop};
    ceres::Solve(solver, &ceres_problem, &summary);
    if (!summary.IsSolutionUsable()) return false;
  }
  cost = summary.final_cost;
  converged = summary.termination_type == ceres::CONVERGENCE;
  return true;
}

// A cost that is nothing but rounding: data without noise, fitted exactly.
double negligible_cost(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches) {
  return 1e-10 * static_cast<double>(problem.residual_count(matches));
}

}  // namespace

bool minimise(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
              const UpdateOptions& options, Eigen::VectorXd& q, double& cost, int held) {
  if (held >= 0 && q.size() == 1) return robust_cost(problem, matches, options, q, cost);
  const auto& coordinates = problem.coordinates();
  const auto coordinate_of = [&](Eigen::Index j) -> const UpdateCoordinate& {
    return coordinates[static_cast<std::size_t>(j)];
  };
  Eigen::VectorXd u(q.size());
  for (Eigen::Index j = 0; j < q.size(); ++j) u[j] = coordinate_of(j).step(q[j]);
  UpdateCost function(problem, matches, options.huber_threshold);
  bool converged = false;
  if (!solve_within_bounds(function, problem, options, held, u, cost, converged)) return false;
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    const auto& coordinate = coordinate_of(j);
    if (j != held) q[j] = std::clamp(coordinate.from_step(u[j]), coordinate.low, coordinate.high);
  }
  // Data without noise: the cost goes on falling by large factors when nothing is left of it.
  return converged || cost < negligible_cost(problem, matches);
}

bool robust_cost(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                 const UpdateOptions& options, const Eigen::VectorXd& q, double& cost) {
  Eigen::VectorXd r;
  if (!problem.residuals(q, matches, r, nullptr)) return false;
  cost = 0;
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    double ignored;
    const bool data = i < r.size() - problem.prior_count();
    cost += 0.5 * std::pow(data ? huber_residual(r[i], options.huber_threshold, ignored) : r[i], 2);
  }
  return true;
}

}  // namespace rigfit::ident
