#include "ident/update/uncertainty/shared_sources.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
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

// Sources that the error bars already contain, by row of the residuals.
struct HeldInBars {
  Eigen::ArrayXd force, place;  // sum_k C_ik^2, in a line's own variance
  Eigen::ArrayXd lines;         // that count as one
  std::vector<Eigen::Index> force_columns;
  [[nodiscard]] Eigen::ArrayXd own_variance(const Eigen::Array3d& shares) const {
    return (1 - shares[0] * force - shares[1] * place).max(shares[2]).min(1);
  }
};
HeldInBars held_in_bars(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                        const SharedChanges& shared) {
  const Eigen::Index residuals = shared.changes.rows();
  HeldInBars held{Eigen::ArrayXd::Zero(residuals),
                  Eigen::ArrayXd::Zero(residuals),
                  Eigen::ArrayXd::Ones(residuals),
                  {}};
  for (Eigen::Index k = 0; k < shared.changes.cols(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (shared.in_error_bars[at] && shared.inputs[at] < 0) held.force_columns.push_back(k);
  }
  for (const auto& rows : problem.frf_rows(matches)) {
    const auto count = 2 * static_cast<Eigen::Index>(rows.relative_std.size());
    // Residuals are over the error bar of so many lines that count as one, C is not.
    const double lines =
        problem.states()[static_cast<std::size_t>(rows.state)].frfs[rows.frf].lines_per_independent;
    held.lines.segment(rows.first, count) = lines;
    for (Eigen::Index k = 0; k < shared.changes.cols(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      if (!shared.in_error_bars[at]) continue;
      auto& sum = shared.inputs[at] < 0 ? held.force : held.place;
      sum.segment(rows.first, count) +=
          lines * shared.changes.col(k).segment(rows.first, count).array().square();
    }
  }
  return held;
}

// The sources d that minimise |D^(-1/2) (r + C (d - before))|^2 + |d|^2.
struct SourceEstimate {
  Eigen::VectorXd scale, d;  // D^(-1/2)
  double chi2 = 0;
};
SourceEstimate estimated(const Eigen::MatrixXd& changes, const Eigen::VectorXd& r,
                         const Eigen::VectorXd& before, const Eigen::VectorXd& own_variance) {
  SourceEstimate found{own_variance.cwiseSqrt().cwiseInverse(), {}, 0};
  const Eigen::MatrixXd C = found.scale.asDiagonal() * changes;
  const Eigen::VectorXd without = found.scale.cwiseProduct(r) - C * before;
  const Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(C.cols(), C.cols()) + C.transpose() * C;
  found.d = -normal.ldlt().solve(C.transpose() * without);
  found.chi2 = (without + C * found.d).squaredNorm() + found.d.squaredNorm();
  return found;
}

}  // namespace

SharedChanges shared_changes(const UpdateProblem& problem, bool segments,
                             const std::vector<UpdateMatch>& matches, const Eigen::VectorXd& q) {
  SharedChanges shared;
  std::vector<Eigen::VectorXd> columns;
  const auto residuals = [&](const UpdateProblem& moved, Eigen::VectorXd& r) {
    return moved.residuals(q, matches, UpdateStage::full, r, nullptr);
  };
  Eigen::VectorXd change;
  const auto add = [&](const std::string& name, Eigen::Index input, bool in_error_bars = false) {
    shared.names.push_back(name);
    shared.inputs.push_back(input);
    shared.in_error_bars.push_back(in_error_bars);
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
      add(name, i, problem.in_error_bars(i));
    } else {
      shared.message += fmt::format(
          "{} is not in the uncertainties, as half its standard uncertainty gave no model; ", name);
    }
  }
  const Eigen::Index count = problem.residual_count(matches, UpdateStage::full);
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
    const double share = problem.has_sources() ? problem.shares()[0] : 1;
    const Eigen::MatrixXd force = std::sqrt(share) * force_columns(all, std, count);
    for (Eigen::Index j = 0; j < force.cols(); ++j) {
      change = problem.with_sources_of(force.col(j));
      add(state.name.empty() ? name : name + " [" + state.name + "]", -1, true);
    }
  }
  shared.changes.resize(count, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    shared.changes.col(static_cast<Eigen::Index>(k)) = columns[k];
  }
  return shared;
}

namespace {

// What the likelihood of the shares needs, linear in the parameters and the sources.
struct LinearSources {
  Eigen::VectorXd r;     // with all sources at zero
  Eigen::MatrixXd J, C;  // C of sources as large as the error bars allow
  HeldInBars held;

  [[nodiscard]] Eigen::MatrixXd scaled_changes(double share_of_force) const {
    Eigen::MatrixXd scaled = C;
    for (const auto k : held.force_columns) scaled.col(k) *= std::sqrt(share_of_force);
    return scaled;
  }

  // -2 ln of the restricted likelihood, but for a constant; `chi2` alone on request.
  [[nodiscard]] double deviance(const Eigen::Array3d& shares, double* chi2 = nullptr) const {
    const Eigen::ArrayXd own = held.own_variance(shares);
    const Eigen::VectorXd scale = own.rsqrt().matrix();
    Eigen::MatrixXd all(r.size(), C.cols() + J.cols());
    all << scaled_changes(shares[0]), J;
    all = scale.asDiagonal() * all;
    const Eigen::VectorXd scaled = scale.cwiseProduct(r);
    Eigen::MatrixXd normal = all.transpose() * all;
    normal.diagonal().head(C.cols()).array() += 1;
    const Eigen::LDLT<Eigen::MatrixXd> solve(normal);
    const Eigen::VectorXd along = all.transpose() * scaled;
    const double least = scaled.squaredNorm() - along.dot(solve.solve(along));
    if (chi2 != nullptr) *chi2 = least;
    return least + (own.log() / held.lines).sum() +
           solve.vectorD().array().abs().max(1e-300).log().sum();
  }
};

// The shares of the largest likelihood, by steps of one share at a time from where they were.
Eigen::Array3d likely_shares(const LinearSources& system, const Eigen::Array3d& before) {
  const std::vector<double> shares{0, 0.25, 0.5, 0.75, 1}, least{1. / 256, 1. / 64, 1. / 16, 0.25};
  const std::array<const std::vector<double>*, 3> grids{&shares, &shares, &least};
  constexpr int kRounds = 8;
  std::array<std::size_t, 3> at{2, 2, 3};
  const auto here = [&](const std::array<std::size_t, 3>& index) {
    return Eigen::Array3d((*grids[0])[index[0]], (*grids[1])[index[1]], (*grids[2])[index[2]]);
  };
  for (std::size_t k = 0; k < at.size(); ++k) {
    for (std::size_t i = 0; i < grids[k]->size(); ++i) {
      if ((*grids[k])[i] == before[static_cast<Eigen::Index>(k)]) at[k] = i;
    }
  }
  double best = system.deviance(here(at));
  for (int round = 0; round < kRounds; ++round) {
    const auto from = at;
    for (std::size_t k = 0; k < at.size(); ++k) {
      for (const int step : {-1, 1}) {
        auto trial = at;
        trial[k] += static_cast<std::size_t>(step);  // wraps below 0, which is past the end
        if (trial[k] >= grids[k]->size()) continue;
        const double deviance = system.deviance(here(trial));
        if (deviance < best) best = deviance, at = trial;
      }
    }
    if (at == from) break;
  }
  return here(at);
}

std::shared_ptr<UpdateProblem::Sources> sources_of(const Eigen::MatrixXd& changes,
                                                   SourceEstimate found,
                                                   const Eigen::VectorXd& off) {
  auto sources = std::make_shared<UpdateProblem::Sources>();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(found.scale.asDiagonal() * changes,
                                              Eigen::ComputeThinU);
  sources->U = svd.matrixU();
  sources->less = 1 - (1 + svd.singularValues().array().square()).rsqrt();
  sources->off = changes * off;
  sources->scale = std::move(found.scale);
  return sources;
}

}  // namespace

UpdateProblem with_shared_sources(const UpdateProblem& problem,
                                  const std::vector<UpdateMatch>& matches,
                                  const Eigen::VectorXd& q) {
  constexpr double kMost = 6;  // standard uncertainties that an estimate may be off
  UpdateProblem plain = problem.with_sources(nullptr);
  const SharedChanges shared = shared_changes(plain, false, matches, q);
  LinearSources system;
  if (shared.changes.size() == 0 || !shared.changes.allFinite() ||
      !plain.residuals(q, matches, UpdateStage::full, system.r, &system.J)) {
    return plain;
  }
  const Eigen::VectorXd r = system.r;
  Eigen::VectorXd off = plain.inputs_off();
  Eigen::VectorXd before = Eigen::VectorXd::Zero(shared.changes.cols());
  for (Eigen::Index k = 0; k < before.size(); ++k) {
    const Eigen::Index input = shared.inputs[static_cast<std::size_t>(k)];
    if (input >= 0) before[k] = off[input];
  }
  system.C = shared.changes;
  system.r -= shared.changes * before;
  system.held = held_in_bars(plain, matches, shared);
  const double dof = static_cast<double>(r.size() - plain.size()) - plain.shared_residuals();
  // Error bars that are too small already hold nothing else.
  constexpr double kTooLarge = 3;  // standard deviations of chi-square
  const Eigen::Array3d none{1, 0, 1};
  double chi2 = 0;
  (void)system.deviance(none, &chi2);
  Eigen::Array3d shares = none;
  if (chi2 < dof + kTooLarge * std::sqrt(2 * std::max(dof, 0.0))) {
    shares = likely_shares(system, problem.shares());
  }
  const Eigen::MatrixXd changes = system.scaled_changes(shares[0]);
  SourceEstimate found = estimated(changes, r, before, system.held.own_variance(shares).matrix());
  // The inputs move, what is linear in its source stays in the residuals.
  Eigen::VectorXd d = Eigen::VectorXd::Zero(before.size());
  for (Eigen::Index k = 0; k < d.size(); ++k) {
    const Eigen::Index input = shared.inputs[static_cast<std::size_t>(k)];
    if (input >= 0) d[k] = off[input] = std::clamp(found.d[k], -kMost, kMost);
  }
  auto sources = sources_of(changes, std::move(found), d);
  sources->shares = shares;
  if ((shares != none).any()) {
    sources->widest = sources_of(shared.changes, {Eigen::VectorXd::Ones(r.size()), {}, 0}, d);
  }
  return plain.with_inputs(off).with_sources(std::move(sources));
}

}  // namespace rigfit::ident
