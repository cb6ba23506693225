#include "ident/update/uncertainty/update_misfit.h"

#include <gsl/gsl_cdf.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "ident/update/uncertainty/frf_correlation.h"
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

// Root tau of chi2(tau) = dof; 0: there is none to be found.
double paule_mandel(const std::function<double(double)>& chi2, double dof) {
  if (dof <= 0 || chi2(0) <= dof) return 0;
  double low = 1e-9, high = 1;
  if (chi2(high) > dof) return 0;  // not these errors' doing
  for (int k = 0; k < 60; ++k) {
    const double middle = std::sqrt(low * high);
    (chi2(middle) > dof ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

// chi2(tau) = rest + sum e^2 / (s^2 + tau^2), of (e^2, s^2).
double paule_mandel(const std::vector<std::pair<double, double>>& errors, double rest, double dof) {
  if (errors.empty()) return 0;
  return paule_mandel(
      [&](double tau) {
        double sum = rest;
        for (const auto& [e2, s2] : errors) sum += e2 / (s2 + tau * tau);
        return sum;
      },
      dof);
}

}  // namespace

double frf_model_std_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                        const Eigen::VectorXd& q) {
  Eigen::VectorXd r;
  if (!problem.residuals(q, matches, r, nullptr)) return 0;
  double rest = r.squaredNorm();
  std::vector<std::pair<double, double>> errors;
  for (const auto& rows : problem.frf_rows(matches)) {
    for (std::size_t i = 0; i < rows.relative_std.size(); ++i) {
      for (int part = 0; part < 2; ++part) {
        const double z = r[rows.first + 2 * static_cast<Eigen::Index>(i) + part];
        const double s2 = std::pow(rows.relative_std[i], 2);
        errors.emplace_back(z * z * s2, s2);
        rest -= z * z;
      }
    }
  }
  return paule_mandel(errors, rest,
                      static_cast<double>(r.size() - problem.size()) - problem.shared_residuals());
}

double model_std_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                    const Eigen::VectorXd& q) {
  const UpdateProblem plain = problem.with_model_std(0);
  Eigen::VectorXd r;
  if (!plain.residuals(q, matches, r, nullptr)) return 0;
  const double dof = static_cast<double>(r.size() - problem.size());
  const auto rows = plain.frequency_rows(matches);
  if (const auto system = linearised(plain, matches, q)) {
    return paule_mandel(
        [&](double tau) {
          Eigen::VectorXd weights = Eigen::VectorXd::Ones(r.size());
          for (const auto& row : rows) {
            const auto& match = matches[row.match];
            const double s = plain.relative_std(match.state, match.measured);
            weights[row.row] = s / std::hypot(s, tau);
          }
          return system->least_chi2(weights);
        },
        dof);
  }
  double rest = r.squaredNorm();
  std::vector<std::pair<double, double>> errors;  // squared error, squared uncertainty
  for (const auto& row : rows) {
    const auto& match = matches[row.match];
    const double s = plain.relative_std(match.state, match.measured);
    errors.emplace_back(std::pow(r[row.row] * s, 2), s * s);
    rest -= r[row.row] * r[row.row];
  }
  return paule_mandel(errors, rest, dof);
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
