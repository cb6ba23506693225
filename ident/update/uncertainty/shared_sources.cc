#include "ident/update/uncertainty/shared_sources.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

namespace rigfit::ident {
namespace {

// The 5 % quantile of the relative uncertainties of a load's lines, of real or imaginary part.
double least_relative_std(const UpdateState& state, std::size_t load) {
  constexpr double kQuantile = 0.05;
  std::vector<double> relative;
  for (const auto& frf : state.frfs) {
    if (frf.load != load || frf.std.size() == 0) continue;
    for (Eigen::Index k = 0; k < frf.H.size(); ++k) {
      const double own = frf.std[k] / std::abs(frf.H[k]);
      if (std::isfinite(own) && own > 0) relative.push_back(own);
    }
  }
  if (relative.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(kQuantile * static_cast<double>(relative.size()));
  std::nth_element(relative.begin(), relative.begin() + at, relative.end());
  return relative[static_cast<std::size_t>(at)];
}

// Columns of the noise on the force of one load in one state.
Eigen::MatrixXd force_columns(const std::vector<const UpdateProblem::FrfRows*>& all, double std,
                              Eigen::Index residuals) {
  constexpr int kDelays = 16;       // a band up to f holds 2 T f = 13.5 of them
  constexpr double kWindow = 6.75;  // T f
  double highest = 0;
  for (const auto* rows : all) {
    for (const double f : rows->frequency_hz) highest = std::max(highest, f);
  }
  const double T = kWindow / highest, each = std * std::sqrt(2.0 / kDelays);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(residuals, kDelays);
  for (const auto* rows : all) {
    for (std::size_t k = 0; k < rows->frequency_hz.size(); ++k) {
      const auto row = rows->first + 2 * static_cast<Eigen::Index>(k);
      for (int j = 0; j < kDelays; ++j) {
        const double tau = T * (static_cast<double>(j) / (kDelays - 1) - 0.5);
        const double phase = 2 * M_PI * rows->frequency_hz[k] * tau;
        columns(row, j) = each * std::cos(phase) / rows->relative_std[k];
        columns(row + 1, j) = -each * std::sin(phase) / rows->relative_std[k];
      }
    }
  }
  return columns;
}

}  // namespace

SharedChanges shared_changes(const UpdateProblem& problem, bool segments,
                             const std::vector<UpdateMatch>& matches, const Eigen::VectorXd& q) {
  SharedChanges shared;
  std::vector<Eigen::VectorXd> columns;
  const auto residuals = [&](const UpdateProblem& moved, Eigen::VectorXd& r) {
    return moved.residuals(q, matches, r, nullptr);
  };
  Eigen::VectorXd change;
  const auto add = [&](const std::string& name, Eigen::Index input) {
    shared.names.push_back(name);
    shared.inputs.push_back(input);
    columns.push_back(change);
  };
  if (segments) {
    if (change_by_segments(problem, residuals, change)) {
      add("segments", -1);
    } else {
      shared.message += "the error of the segments is unknown, as twice as many gave no model; ";
    }
  }
  const Eigen::Index inputs = problem.inputs_off().size();
  for (Eigen::Index i = 0; i < inputs; ++i) {
    const auto& name = problem.inputs()[static_cast<std::size_t>(i)].name;
    if (change_by_input(problem, i, residuals, change)) {
      add(name, i);
    } else {
      shared.message += fmt::format(
          "{} is not in the uncertainties, as half its standard uncertainty gave no model; ", name);
    }
  }
  const Eigen::Index count = problem.residual_count(matches);
  const auto frf_rows = problem.frf_rows(matches);
  std::map<std::pair<int, std::size_t>, std::vector<const UpdateProblem::FrfRows*>> by_load;
  for (const auto& rows : frf_rows) {
    if (!rows.frequency_hz.empty()) by_load[{rows.state, rows.load}].push_back(&rows);
  }
  for (const auto& [of, all] : by_load) {
    const auto& state = problem.states()[static_cast<std::size_t>(of.first)];
    const double std = least_relative_std(state, of.second);
    if (!(std > 0)) continue;
    const std::string name = "force of the hits of " + state.scene.loads[of.second].name;
    const Eigen::MatrixXd force = force_columns(all, std, count);
    for (Eigen::Index j = 0; j < force.cols(); ++j) {
      change = problem.with_sources_of(force.col(j));
      add(state.name.empty() ? name : name + " [" + state.name + "]", -1);
    }
  }
  shared.changes.resize(count, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    shared.changes.col(static_cast<Eigen::Index>(k)) = columns[k];
  }
  return shared;
}

UpdateProblem with_shared_sources(const UpdateProblem& problem,
                                  const std::vector<UpdateMatch>& matches,
                                  const Eigen::VectorXd& q) {
  constexpr double kMost = 6;  // standard uncertainties that an estimate may be off
  UpdateProblem plain = problem.with(&UpdateVariant::sources, nullptr);
  const SharedChanges shared = shared_changes(plain, false, matches, q);
  const Eigen::MatrixXd& C = shared.changes;
  Eigen::VectorXd r;
  if (C.size() == 0 || !C.allFinite() || !plain.residuals(q, matches, r, nullptr)) {
    return plain;
  }
  // The sources d that minimise |r + C (d - before)|^2 + |d|^2. The inputs move there, what is
  // linear in its source stays in the residuals.
  Eigen::VectorXd off = plain.inputs_off(), d = Eigen::VectorXd::Zero(C.cols());
  for (Eigen::Index k = 0; k < d.size(); ++k) {
    const Eigen::Index input = shared.inputs[static_cast<std::size_t>(k)];
    if (input >= 0) d[k] = off[input];
  }
  const Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(C.cols(), C.cols()) + C.transpose() * C;
  const Eigen::VectorXd found = -normal.ldlt().solve(C.transpose() * (r - C * d));
  for (Eigen::Index k = 0; k < d.size(); ++k) {
    const Eigen::Index input = shared.inputs[static_cast<std::size_t>(k)];
    if (input >= 0) d[k] = off[input] = std::clamp(found[k], -kMost, kMost);
  }
  auto sources = std::make_shared<SharedSources>();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(C, Eigen::ComputeThinU);
  sources->U = svd.matrixU();
  sources->less = 1 - (1 + svd.singularValues().array().square()).rsqrt();
  sources->off = C * d;
  return plain.with(&UpdateVariant::inputs_off, off)
      .with(&UpdateVariant::sources, std::move(sources));
}

}  // namespace rigfit::ident
