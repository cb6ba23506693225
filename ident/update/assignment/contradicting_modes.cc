#include "ident/update/assignment/contradicting_modes.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace rigfit::ident {
namespace {

constexpr double kMisfit = 9, kAgreement = 3;  // chi-squared a degree of freedom
constexpr double kLeastFreedom = 2;            // degrees of freedom that are left

/// Chi-squared a degree of freedom; infinite without a model or without freedom.
double chi_squared_per_degree(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                              const Eigen::VectorXd& q) {
  Eigen::VectorXd r;
  if (!problem.residuals(q, matches, UpdateStage::full, r, nullptr) ||
      static_cast<double>(r.size() - problem.size()) < kLeastFreedom) {
    return std::numeric_limits<double>::infinity();
  }
  return r.squaredNorm() / static_cast<double>(r.size() - problem.size());
}

}  // namespace

bool is_misfit(const UpdateProblem& problem, const UpdateSolution& solution) {
  if (!problem.uncertainties_known() || problem.has_frfs()) return false;
  const double misfit = chi_squared_per_degree(problem, solution.matches.matches, solution.q);
  return misfit > kMisfit && std::isfinite(misfit);
}

void leave_out_contradictions(const UpdateProblem& problem, const UpdateOptions& options,
                              UpdateSolution& solution) {
  if (!is_misfit(problem, solution)) return;
  UpdateSolution trial = solution;
  std::vector<UpdateMatch> out;
  const std::size_t most = std::max<std::size_t>(1, solution.matches.matches.size() / 5);
  double left = std::numeric_limits<double>::infinity();
  while (out.size() < most && left > kAgreement) {
    const std::vector<UpdateMatch> all = trial.matches.matches;
    const Eigen::VectorXd from = trial.q;
    std::size_t best = all.size();
    left = std::numeric_limits<double>::infinity();
    // Which one: by what its loss leaves to first order, r_i^2 / (1 - h_ii); that one is fitted.
    Eigen::VectorXd r;
    Eigen::MatrixXd J;
    if (!problem.residuals(from, all, UpdateStage::full, r, &J)) return;
    const Eigen::MatrixXd leverage =
        (J.transpose() * J).completeOrthogonalDecomposition().solve(J.transpose());
    double most_gained = 0;
    for (const auto& row : problem.frequency_rows(all, UpdateStage::full)) {
      const double h = J.row(row.row).dot(leverage.col(row.row));
      const double gained = r[row.row] * r[row.row] / std::max(1 - h, 1e-6);
      if (gained <= most_gained) continue;
      most_gained = gained;
      best = row.match;
    }
    if (best < all.size()) {
      std::vector<UpdateMatch> rest = all;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(best));
      Eigen::VectorXd q = from;
      double cost = 0;
      if (!minimise(problem, rest, UpdateStage::full, options, q, cost)) return;
      left = chi_squared_per_degree(problem, rest, q);
      trial.q = q;
      trial.matches.matches = std::move(rest);
    }
    if (best == all.size()) return;
    out.push_back(all[best]);
  }
  if (left > kAgreement) return;
  for (const UpdateMatch& match : out) {
    Eigen::VectorXd r;
    std::string by;
    if (problem.residuals(trial.q, {match}, UpdateStage::full, r, nullptr)) {
      by = fmt::format("by {:.0f} standard deviations ", std::abs(r[0]));
    }
    UpdatedUnpaired one;
    one.state = match.state;
    one.frequency_hz = problem.states()[static_cast<std::size_t>(match.state)]
                           .measured[static_cast<std::size_t>(match.measured)]
                           .frequency_hz.value;
    one.reason =
        "contradicts " + by + "what all the others agree on within their uncertainties: left out";
    trial.matches.unpaired.push_back(std::move(one));
  }
  solution = std::move(trial);
}

}  // namespace rigfit::ident
