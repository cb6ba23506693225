#include "ident/update/problem/update_problem.h"

#include <ceres/cost_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

namespace rigfit::ident {
namespace {

class UpdateCost : public ceres::CostFunction {
 public:
  UpdateCost(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches)
      : problem_(problem), matches_(matches) {
    set_num_residuals(static_cast<int>(problem.residual_count(matches)));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.size()));
  }
  bool Evaluate(double const* const* blocks, double* out, double** jacobians) const override {
    const VectorXd q = Map<const VectorXd>(blocks[0], problem_.size());
    // Most steps are taken: the Jacobian found with the residuals of a trial serves when it is
    // asked for.
    if (q_.size() == 0 || q != q_) {
      q_.resize(0);
      if (!problem_.residuals(q, matches_, r_, &J_)) return false;
      q_ = q;
    }
    Map<VectorXd>(out, r_.size()) = r_;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Map<RowMajor>(jacobians[0], J_.rows(), J_.cols()) = J_;
    }
    return true;
  }
  /// Where the cost falls by less than its tolerance, Ceres leaves the last step.
  void take_last_step(VectorXd& q, double& cost) const {
    const double last = 0.5 * r_.squaredNorm();
    if (q_.size() > 0 && last < cost) q = q_, cost = last;
  }

 private:
  const UpdateProblem& problem_;
  const std::vector<UpdateMatch>& matches_;
  mutable VectorXd q_, r_;  // the last point; of one solver, on its thread
  mutable MatrixXd J_;
};

}  // namespace

bool minimise(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches, VectorXd& q,
              double& cost, double tolerance, int held) {
  if (held >= 0 && q.size() == 1) return cost_of(problem, matches, q, cost);
  VectorXd u = q;
  UpdateCost function(problem, matches);
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem ceres_problem(ownership);
  ceres_problem.AddResidualBlock(&function, nullptr, u.data());
  for (int j = 0; j < static_cast<int>(u.size()); ++j) {
    const auto& at = problem.coordinate_at(j);
    if (std::isfinite(at.low)) ceres_problem.SetParameterLowerBound(u.data(), j, at.low);
    if (std::isfinite(at.high)) ceres_problem.SetParameterUpperBound(u.data(), j, at.high);
  }
  if (held >= 0) {
    ceres_problem.SetManifold(u.data(),
                              new ceres::SubsetManifold(static_cast<int>(u.size()), {held}));
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.logging_type = ceres::SILENT;
  solver.max_num_iterations = 60;
  solver.function_tolerance = tolerance;
  solver.parameter_tolerance = 1e-9;
  solver.gradient_tolerance = 1e-9;
  // What the pairs leave open would otherwise run off along its valley.
  solver.min_lm_diagonal = 1e-4;
  // Valleys of tension and springs are curved: the first steps that the default of 1e4 allows fail.
  solver.initial_trust_region_radius = 100;
  solver.max_num_line_search_step_size_iterations = 0;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &ceres_problem, &summary);
  if (!summary.IsSolutionUsable()) return false;
  q = u;
  cost = summary.final_cost;
  function.take_last_step(q, cost);
  // Data without noise: the cost goes on falling by large factors when nothing is left of it.
  return summary.termination_type == ceres::CONVERGENCE ||
         cost < 1e-10 * static_cast<double>(problem.residual_count(matches));
}

bool cost_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
             const VectorXd& q, double& cost) {
  VectorXd r;
  if (!problem.residuals(q, matches, r, nullptr)) return false;
  cost = 0.5 * r.squaredNorm();
  return true;
}

}  // namespace rigfit::ident
