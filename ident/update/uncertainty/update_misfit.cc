#include "ident/update/uncertainty/update_misfit.h"

#include <gsl/gsl_cdf.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "ident/statistics/root.h"
#include "ident/update/uncertainty/frf_correlation.h"

namespace rigfit::ident {

namespace {

// The least-squares problem about q, to first order, in normal form.
class Linearised {
 public:
  Linearised(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
             const Eigen::VectorXd& q) {
    usable_ = problem.residuals(q, matches, r_, &J_);
    for (Eigen::Index j = 0; usable_ && j < J_.cols(); ++j) {  // what is at its bound stays there
      const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
      if (q[j] <= coordinate.low + 1e-9 || q[j] >= coordinate.high - 1e-9) J_.col(j).setZero();
    }
  }
  [[nodiscard]] bool usable() const { return usable_; }
  [[nodiscard]] const Eigen::VectorXd& residuals() const { return r_; }

  // Residuals where the sum of squares of weights * residuals is least.
  [[nodiscard]] Eigen::VectorXd least(const Eigen::VectorXd& weights) const {
    const Eigen::MatrixXd A = weights.asDiagonal() * J_;
    const Eigen::VectorXd b = weights.cwiseProduct(r_);
    const Eigen::MatrixXd normal = A.transpose() * A;
    return r_ - J_ * normal.completeOrthogonalDecomposition().solve(A.transpose() * b);
  }

 private:
  bool usable_ = false;
  Eigen::VectorXd r_;
  Eigen::MatrixXd J_;
};

}  // namespace

UpdateFit misfit_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                    const Eigen::VectorXd& q) {
  UpdateFit fit;
  fit.stated = problem.uncertainties_known();
  const UpdateProblem plain = problem.with_model_std(0);
  Eigen::VectorXd r;
  if (problem.variant().model_std > 0) {  // q is not the minimum without it
    const Linearised system(plain, matches, q);
    if (!system.usable()) return fit;
    r = system.least(Eigen::VectorXd::Ones(system.residuals().size()));
  } else if (!plain.residuals(q, matches, r, nullptr)) {
    return fit;
  }
  fit.chi2 = r.squaredNorm();
  fit.degrees_of_freedom =
      static_cast<double>(r.size() - problem.size()) - problem.shared_residuals();
  fit.correlated_lines = correlated_lines_of(plain, matches, r);
  if (!(fit.degrees_of_freedom > 0)) return fit;
  fit.p_value = gsl_cdf_chisq_Q(fit.chi2 / fit.correlated_lines,
                                fit.degrees_of_freedom / fit.correlated_lines);
  return fit;
}

double model_std_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                    const Eigen::VectorXd& q) {
  const bool frfs = problem.has_frfs();
  const UpdateProblem plain = frfs ? problem : problem.with_model_std(0);
  const Linearised system(plain, matches, q);
  if (!system.usable()) return 0;
  const Eigen::Index count = system.residuals().size();
  std::vector<std::pair<Eigen::Index, double>> rows;  // with their relative uncertainty
  if (frfs) {
    for (const auto& one : plain.frf_rows(matches)) {
      Eigen::Index row = one.first;
      for (const double own : one.relative_std) {
        for (int part = 0; part < 2; ++part) rows.emplace_back(row++, own);
      }
    }
  } else {
    for (const auto& row : plain.frequency_rows(matches)) {
      const auto& match = matches[row.match];
      rows.emplace_back(row.row, plain.relative_std(match.state, match.measured));
    }
  }
  const double dof = static_cast<double>(count - problem.size()) - problem.shared_residuals();
  const auto excess = [&](double log_tau) {
    Eigen::VectorXd weights = Eigen::VectorXd::Ones(count);
    for (const auto& [row, own] : rows) weights[row] = own / std::hypot(own, std::exp(log_tau));
    return weights.cwiseProduct(system.least(weights)).squaredNorm() - dof;
  };
  const double low = std::log(1e-9), high = 0;
  if (dof <= 0 || excess(low) <= 0 || excess(high) > 0) return 0;
  return std::exp(root_between(low, high, 1e-6, excess));
}

void settle_frfs(const UpdateOptions& options, UpdateProblem& settled, UpdateSolution& answer,
                 UpdateResult& result) {
  if (!settled.has_frfs()) return;
  const auto& matches = answer.matches.matches;
  const auto move_to = [&](const UpdateProblem& trial) {
    Eigen::VectorXd q = answer.q;
    double cost = 0;
    const bool converged = minimise(trial, matches, options, q, cost);
    if (!converged && !cost_of(trial, matches, q, cost)) return;
    answer.q = std::move(q);
    answer.cost = cost;
    answer.converged = converged;
    settled = trial;
  };
  move_to(
      settled.with(&UpdateVariant::frf_model_std, 0).with(&UpdateVariant::frf_differences, true));
  const UpdateFit fit = misfit_of(settled, matches, answer.q);
  if (!(fit.p_value < kUnlikelyMisfit) || !fit.stated) return;
  const double tau = model_std_of(settled, matches, answer.q);
  if (!(tau > 0)) return;
  result.fit = fit;
  result.fit.frf_model_std = tau;
  move_to(settled.with(&UpdateVariant::frf_model_std, tau));
}

Eigen::VectorXd clustered_variance(const UpdateProblem& problem,
                                   const std::vector<UpdateMatch>& matches,
                                   const Eigen::VectorXd& r, const Eigen::MatrixXd& J) {
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(J.cols());
  std::map<std::pair<int, int>, Eigen::VectorXd> by_mode;
  std::map<int, Eigen::VectorXd> by_state;
  for (const auto& row : problem.frequency_rows(matches)) {
    const auto& match = matches[row.match];
    const Eigen::VectorXd score = J.row(row.row).transpose() * r[row.row];
    for (auto* sum :
         {&by_mode
               .try_emplace({static_cast<int>(match.plane), match.order},
                            Eigen::VectorXd::Zero(J.cols()))
               .first->second,
          &by_state.try_emplace(match.state, Eigen::VectorXd::Zero(J.cols())).first->second}) {
      *sum += score;
    }
  }
  const Eigen::MatrixXd bread =
      (J.transpose() * J).completeOrthogonalDecomposition().pseudoInverse();
  const auto widen = [&](const auto& clusters) {
    const double count = static_cast<double>(clusters.size());
    if (count < 3) return;
    Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(J.cols(), J.cols());
    for (const auto& [name, score] : clusters) meat += score * score.transpose();
    const Eigen::MatrixXd covariance = bread * meat * bread * (count / (count - 1));
    largest = largest.cwiseMax(covariance.diagonal());
  };
  widen(by_mode);
  widen(by_state);
  return largest;
}

}  // namespace rigfit::ident
