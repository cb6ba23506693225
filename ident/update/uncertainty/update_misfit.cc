#include "ident/update/uncertainty/update_misfit.h"

#include <gsl/gsl_cdf.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "ident/update/uncertainty/shared_sources.h"

namespace rigfit::ident {

namespace {

// Residuals of a fit to modes and their changes with parameters and inputs: the first order.
struct Linearised {
  Eigen::VectorXd r;
  Eigen::MatrixXd A;        // by coordinate, then by one standard uncertainty of each input
  Eigen::Index inputs = 0;  // the last columns of A

  // min over x of |W (r + A x)|^2 + |the inputs' part of x|^2, W by row.
  [[nodiscard]] double least_chi2(const Eigen::VectorXd& weights) const {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(r.size() + inputs, A.cols());
    all.topRows(r.size()) = weights.asDiagonal() * A;
    all.bottomRightCorner(inputs, inputs).setIdentity();
    Eigen::VectorXd b = Eigen::VectorXd::Zero(all.rows());
    b.head(r.size()) = weights.cwiseProduct(r);
    return (b - all * all.completeOrthogonalDecomposition().solve(b)).squaredNorm();
  }
};

// Empty: there are no inputs.
std::optional<Linearised> linearised(const UpdateProblem& problem,
                                     const std::vector<UpdateMatch>& matches,
                                     const Eigen::VectorXd& q) {
  if (!problem.modes_only() || problem.has_sources() || problem.inputs_off().size() == 0) {
    return std::nullopt;
  }
  const Eigen::MatrixXd C = shared_changes(problem, false, matches, q).changes;
  Linearised system;
  Eigen::MatrixXd J;
  if (C.cols() == 0 || !C.allFinite() || !problem.residuals(q, matches, system.r, &J)) {
    return std::nullopt;
  }
  for (Eigen::Index j = 0; j < J.cols(); ++j) {  // a parameter at its bound stays there
    const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
    if (q[j] <= coordinate.low + 1e-9 || q[j] >= coordinate.high - 1e-9) J.col(j).setZero();
  }
  system.inputs = C.cols();
  system.A.resize(J.rows(), J.cols() + C.cols());
  system.A << J, C;
  return system;
}

}  // namespace

std::optional<double> chi2_with_inputs(const UpdateProblem& problem,
                                       const std::vector<UpdateMatch>& matches,
                                       const Eigen::VectorXd& q) {
  const auto system = linearised(problem, matches, q);
  if (!system) return std::nullopt;
  return system->least_chi2(Eigen::VectorXd::Ones(system->r.size()));
}

UpdateFit misfit_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                    const Eigen::VectorXd& q) {
  UpdateFit fit;
  fit.stated = problem.uncertainties_known();
  const UpdateProblem plain = problem.with_model_std(0);
  Eigen::VectorXd r;
  if (!plain.residuals(q, matches, r, nullptr)) return fit;
  fit.chi2 = r.squaredNorm();
  fit.degrees_of_freedom =
      static_cast<double>(r.size() - problem.size()) - problem.shared_residuals();
  fit.correlated_lines = correlated_lines_of(plain, matches, r);
  if (!(fit.degrees_of_freedom > 0)) return fit;
  const auto probability = [&] {
    return gsl_cdf_chisq_Q(fit.chi2 / fit.correlated_lines,
                           fit.degrees_of_freedom / fit.correlated_lines);
  };
  fit.p_value = probability();
  if (!(fit.p_value < kUnlikelyMisfit)) return fit;
  if (const auto chi2 = chi2_with_inputs(plain, matches, q); chi2 && *chi2 < fit.chi2) {
    fit.by_inputs = fit.chi2 - *chi2;
    fit.chi2 = *chi2;
    fit.p_value = probability();
  }
  return fit;
}

namespace {

// Relative error tau that rows of these relative uncertainties must have beside them for chi2 to be
// `dof` (Paule and Mandel); 0: none, or none that would do.
double more_std(const Eigen::VectorXd& r, const std::vector<std::pair<Eigen::Index, double>>& rows,
                const std::optional<Linearised>& system, double dof) {
  const auto chi2 = [&](double tau) {
    Eigen::VectorXd weights = Eigen::VectorXd::Ones(r.size());
    for (const auto& [row, own] : rows) weights[row] = own / std::hypot(own, tau);
    return system ? system->least_chi2(weights) : weights.cwiseProduct(r).squaredNorm();
  };
  double low = 1e-9, high = 1;
  if (dof <= 0 || chi2(0) <= dof || chi2(high) > dof) return 0;
  for (int k = 0; k < 60; ++k) {
    const double middle = std::sqrt(low * high);
    (chi2(middle) > dof ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

}  // namespace

double model_std_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                    const Eigen::VectorXd& q) {
  const bool frfs = problem.has_frfs();
  const UpdateProblem plain = frfs ? problem : problem.with_model_std(0);
  Eigen::VectorXd r;
  if (!plain.residuals(q, matches, r, nullptr)) return 0;
  std::vector<std::pair<Eigen::Index, double>> rows;
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
  const double dof = static_cast<double>(r.size() - problem.size()) - problem.shared_residuals();
  return more_std(r, rows, linearised(plain, matches, q), dof);
}

void allow_for_shared(const UpdateOptions& options, UpdateProblem& settled, UpdateSolution& answer,
                      UpdateResult& result) {
  if (!settled.has_frfs()) return;
  settled =
      settled.with(&UpdateVariant::frf_model_std, 0).with(&UpdateVariant::frf_differences, true);
  const auto& matches = answer.matches.matches;
  const auto again = [&](const UpdateProblem& trial) {
    Eigen::VectorXd q = answer.q;
    double cost = 0;
    const bool converged = minimise(trial, matches, options, q, cost);
    if (!converged && !robust_cost(trial, matches, options, q, cost)) return;
    answer.q = std::move(q);
    answer.cost = cost;
    answer.converged = converged;
    settled = trial;
  };
  if (settled.inputs().size() == options.inputs.size()) {
    settled = settled.with_places_of_hits(answer.q);
  }
  constexpr int kPasses = 6;
  for (int pass = 0; pass < kPasses; ++pass) {
    const Eigen::VectorXd before = answer.q, off = settled.inputs_off();
    again(with_shared_sources(settled, matches, answer.q));
    if (!settled.has_sources()) break;
    if ((answer.q - before).norm() < 1e-6 && (settled.inputs_off() - off).norm() < 1e-3) break;
  }
  const UpdateFit fit = misfit_of(settled, matches, answer.q);
  if (!(fit.p_value < kUnlikelyMisfit) || !fit.stated) return;
  const double tau = model_std_of(settled, matches, answer.q);
  if (!(tau > 0)) return;
  result.fit = fit;
  result.fit.frf_model_std = tau;
  again(with_shared_sources(settled.with(&UpdateVariant::frf_model_std, tau), matches, answer.q));
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
