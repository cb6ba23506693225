#include "ident/update/update_checks.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "ident/statistics/in_parallel.h"
#include "ident/update/problem/update_solver.h"
#include "ident/update/uncertainty/update_segments.h"
#include "ident/update/uncertainty/update_uncertainty.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;

// For each row of values (rows x samples): mean, standard deviation, central 95 % interval.
struct Spread {
  Eigen::VectorXd mean, std, low, high;
};
Spread spread_of(const Eigen::MatrixXd& values) {
  Spread spread;
  const double samples = static_cast<double>(values.cols());
  spread.mean = values.rowwise().mean();
  spread.std =
      ((values.colwise() - spread.mean).rowwise().squaredNorm() / (samples - 1)).cwiseSqrt();
  spread.low.resize(values.rows()), spread.high.resize(values.rows());
  for (Eigen::Index j = 0; j < values.rows(); ++j) {
    Eigen::VectorXd sorted = values.row(j);
    std::sort(sorted.begin(), sorted.end());
    const auto at = [&](double p) {
      return sorted[static_cast<Eigen::Index>(std::lround(p * (samples - 1)))];
    };
    spread.low[j] = at(0.025);
    spread.high[j] = at(0.975);
  }
  return spread;
}

// Frequencies of the matches; false when the model lacks one.
bool frequencies_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                    const Eigen::VectorXd& q, Eigen::VectorXd& frequencies) {
  frequencies.resize(static_cast<Eigen::Index>(matches.size()));
  const bool leakage = std::any_of(matches.begin(), matches.end(),
                                   [](const auto& match) { return match.cross_plane; });
  int current = -1;
  UpdateStateModes modelled;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const auto& match = matches[i];
    if (match.state != current) {
      modelled = problem.modes(match.state, q, false, leakage ? nullptr : &matches);
    }
    current = match.state;
    const auto* mode = modelled.find(match.plane, match.order);
    if (mode == nullptr) return false;
    frequencies[static_cast<Eigen::Index>(i)] = mode->frequency_hz;
  }
  return true;
}

std::vector<UpdateMatch> matches_of(const UpdateResult& solution) {
  std::vector<UpdateMatch> matches;
  for (const auto& pair : solution.pairs) {
    matches.push_back(
        {pair.state, pair.measured, pair.plane, pair.order, pair.mac, pair.cross_plane});
  }
  return matches;
}

}  // namespace

std::vector<HeldOut> hold_out_each(const std::vector<UpdateState>& states,
                                   const std::vector<FreeParameter>& free,
                                   const UpdateOptions& given) {
  UpdateOptions options = given;
  options.intervals = false;  // the prediction needs the covariance alone
  std::vector<HeldOut> result(states.size());
  in_parallel(states.size(), options.threads, [&](std::size_t index) {
    const int s = static_cast<int>(index);
    HeldOut& held = result[index];
    held.state = s;
    held.rms_fitted = held.rms_predicted = held.rms_before = kNaN;
    held.frf_fitted = held.frf_predicted = held.frf_before = kNaN;
    const UpdateProblem problem(states, free, options, s);
    const UpdateResult fitted = update_result(problem, options);
    held.status = fitted.status;
    std::string failure;
    const auto before = problem.match(problem.start(), failure, s);
    if (failure.empty())
      held.rms_before = rms_of_pairs(problem.pairs(problem.start(), before.matches));
    if (problem.has_frfs()) held.frf_before = problem.rms_log_frf_error(problem.start(), s);
    if (fitted.coordinates.size() > 0) {
      held.frf_fitted = fitted.rms_log_frf_error;
      held.rms_fitted = fitted.rms_relative_error;
      // Its own values, where a parameter has one a state, stay as they were known before.
      Eigen::VectorXd q = fitted.coordinates;
      for (Eigen::Index j = 0; j < problem.size(); ++j) {
        const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
        if (coordinate.state == s) q[j] = coordinate.start;
      }
      const UpdateProblem solved = as_solved(problem, options, fitted, q);
      held.scene = solved.scene_at(s, q);
      if (problem.has_frfs()) held.frf_predicted = solved.rms_log_frf_error(q, s);
      failure.clear();
      const auto after = solved.match(q, failure, s);
      if (failure.empty()) {
        held.pairs = solved.pairs(q, after.matches);
        held.rms_predicted = rms_of_pairs(held.pairs);
        state_prediction_uncertainty(solved, options, fitted, q, s, held.pairs);
      }
    }
  });
  return result;
}

UpdateMonteCarlo update_monte_carlo(const UpdateResult& solution,
                                    const std::vector<UpdateState>& states,
                                    const std::vector<FreeParameter>& free,
                                    const UpdateOptions& options, int samples,
                                    const std::function<void()>& progress) {
  UpdateMonteCarlo result;
  const auto n = solution.coordinates.size();
  if (n == 0) return result;
  const std::vector<UpdateMatch> matches = matches_of(solution);
  const UpdateProblem solved =
      as_solved(UpdateProblem(states, free, options), options, solution, solution.coordinates);
  // The truth of the experiment is the fitted model: what was measured is drawn about it.
  const double spread = std::sqrt(solution.variance_factor);
  std::vector<Eigen::VectorXd> values(static_cast<std::size_t>(samples)), fitted(values.size()),
      before(values.size());
  in_parallel(values.size(), options.threads, [&](std::size_t k) {
    std::mt19937_64 random(options.seed * 0x9E3779B97F4A7C15ULL + k);
    std::normal_distribution<double> normal;
    UpdateProblem problem = solved;
    for (const auto& pair : solution.pairs) {
      const double s = spread * problem.relative_std(pair.state, pair.measured);
      const double damping_std = problem.damping_relative_std(pair.state, pair.measured);
      const double frequency = pair.model_hz * std::exp(s * normal(random));
      const double damping = pair.model_damping * std::exp(damping_std * normal(random));
      problem.set_measured(pair.state, pair.measured, frequency, damping);
    }
    if (problem.has_frfs() &&
        !problem.redraw_frfs(solution.coordinates, spread, [&] { return normal(random); })) {
      return;
    }
    Eigen::VectorXd start = problem.start();
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
      if (coordinate.prior_std > 0) {
        const double off = coordinate.prior_std * normal(random);
        start[j] = std::clamp(coordinate.prior + off, coordinate.low, coordinate.high);
        problem.set_prior(j, solution.coordinates[j] + off);
      }
    }
    Eigen::VectorXd q = solution.coordinates, frequencies, first;
    double cost = 0;
    if (minimise(problem, matches, options, q, cost) &&
        frequencies_of(problem, matches, q, frequencies)) {
      if (frequencies_of(problem, matches, start, first)) before[k] = std::move(first);
      fitted[k] = std::move(frequencies);
      values[k].resize(solved.parameter_count());
      for (Eigen::Index j = 0; j < solved.parameter_count(); ++j) {
        values[k][j] = problem.coordinates()[static_cast<std::size_t>(j)].value(q[j]);
      }
    }
    if (progress) progress();
  });

  const auto together = [](std::vector<Eigen::VectorXd>& columns) {
    std::erase_if(columns, [](const auto& column) { return column.size() == 0; });
    Eigen::MatrixXd all(columns.empty() ? 0 : columns[0].size(),
                        static_cast<Eigen::Index>(columns.size()));
    for (Eigen::Index k = 0; k < all.cols(); ++k) all.col(k) = columns[static_cast<std::size_t>(k)];
    return all;
  };
  result.values = together(values);
  result.samples = static_cast<int>(values.size());
  result.failed = samples - result.samples;
  if (result.samples < 2) return result;
  const Spread parameters = spread_of(result.values);
  result.mean = parameters.mean, result.std = parameters.std;
  result.low = parameters.low, result.high = parameters.high;
  for (auto [columns, out] : {std::pair{&fitted, &result.fitted}, {&before, &result.before}}) {
    const Eigen::MatrixXd all = together(*columns);
    if (all.cols() < 2 || all.rows() == 0) continue;
    const Spread each = spread_of(all);
    *out = {each.mean, each.std, each.low, each.high};
  }
  return result;
}

}  // namespace rigfit::ident
