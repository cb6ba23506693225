#include "ident/update/uncertainty/update_misfit.h"

#include <gsl/gsl_cdf.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>

#include "ident/statistics/root.h"

namespace rigfit::ident {

UpdateFit misfit_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                    const Eigen::VectorXd& q) {
  UpdateFit fit;
  fit.stated = problem.uncertainties_known();
  Eigen::VectorXd r;
  if (!problem.residuals(q, matches, r, nullptr)) return fit;
  fit.chi2 = r.squaredNorm();
  fit.degrees_of_freedom =
      static_cast<double>(r.size() - problem.size()) - problem.shared_residuals();
  if (!(fit.degrees_of_freedom > 0)) return fit;
  fit.p_value = gsl_cdf_chisq_Q(fit.chi2, fit.degrees_of_freedom);
  return fit;
}

double model_std_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                    const Eigen::VectorXd& q) {
  Eigen::VectorXd r;
  Eigen::MatrixXd J;
  if (!problem.residuals(q, matches, r, &J)) return 0;
  for (Eigen::Index j = 0; j < problem.parameter_count(); ++j) {  // at its bound it stays there
    const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
    if (q[j] <= coordinate.low + 1e-9 || q[j] >= coordinate.high - 1e-9) J.col(j).setZero();
  }
  Eigen::VectorXd own = Eigen::VectorXd::Zero(r.size());  // relative uncertainty; 0: no data
  for (const auto& rows : problem.frf_rows(matches)) {
    for (std::size_t k = 0; k < rows.relative_std.size(); ++k) {
      own.segment<2>(rows.first + 2 * static_cast<Eigen::Index>(k)).fill(rows.relative_std[k]);
    }
  }
  for (const auto& row : problem.frequency_rows(matches)) {
    if (problem.has_frfs()) break;
    const auto& match = matches[row.match];
    own[row.row] = problem.relative_std(match.state, match.measured);
  }
  const double dof = static_cast<double>(r.size() - problem.size()) - problem.shared_residuals();
  const auto excess = [&](double log_tau) {
    Eigen::VectorXd w = Eigen::VectorXd::Ones(r.size());
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      if (own[i] > 0) w[i] = own[i] / std::hypot(own[i], std::exp(log_tau));
    }
    const Eigen::MatrixXd A = w.asDiagonal() * J;
    const Eigen::VectorXd b = w.cwiseProduct(r);
    const Eigen::MatrixXd normal = A.transpose() * A;
    return (b - A * normal.completeOrthogonalDecomposition().solve(A.transpose() * b))
               .squaredNorm() -
           dof;
  };
  const double low = std::log(1e-9), high = 0;
  if (dof <= 0 || excess(low) <= 0 || excess(high) > 0) return 0;
  return std::exp(root_between(low, high, 1e-6, excess));
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
