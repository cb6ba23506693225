// Hold-out and Monte Carlo of the update.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <random>
#include <thread>

#include "ident/model_update.h"
#include "ident/update_solver.h"
#include "signal/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;

}  // namespace

std::vector<HeldOut> hold_out_each(const std::vector<UpdateState>& states,
                                   const std::vector<FreeParameter>& free,
                                   const UpdateOptions& options) {
  std::vector<HeldOut> result;
  for (int s = 0; s < static_cast<int>(states.size()); ++s) {
    HeldOut held;
    held.state = s;
    held.rms_fitted = held.rms_predicted = held.rms_before = kNaN;
    held.frf_fitted = held.frf_predicted = held.frf_before = kNaN;
    const UpdateProblem problem(states, free, options, s);
    const UpdateResult fitted = update_result(problem, options);
    held.status = fitted.status;
    std::string failure;
    const auto before = problem.match(problem.start(), 1, failure, s);
    if (failure.empty())
      held.rms_before = rms_of_pairs(problem.pairs(problem.start(), before.matches));
    if (problem.has_frfs()) held.frf_before = problem.rms_log_frf_error(problem.start(), s);
    if (fitted.coordinates.size() > 0) {
      held.frf_fitted = fitted.rms_log_frf_error;
      held.rms_fitted = fitted.rms_relative_error;
      // Its own values, where a parameter has one a state, stay as they were known before.
      Eigen::VectorXd q = fitted.coordinates;
      for (Eigen::Index j = 0; j < q.size(); ++j) {
        const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
        if (coordinate.state == s) q[j] = coordinate.start;
      }
      held.scene = problem.scene_at(s, q);
      if (problem.has_frfs()) held.frf_predicted = problem.rms_log_frf_error(q, s);
      failure.clear();
      const auto after = problem.match(q, 1, failure, s);
      if (failure.empty()) {
        held.pairs = problem.pairs(q, after.matches);
        held.rms_predicted = rms_of_pairs(held.pairs);
      }
    }
    result.push_back(std::move(held));
  }
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
  std::vector<UpdateMatch> matches;
  for (const auto& pair : solution.pairs) {
    matches.push_back(
        {pair.state, pair.measured, pair.plane, pair.order, pair.mac, pair.cross_plane});
  }
  // The truth of the experiment is the fitted model: what was measured is drawn about it.
  const double spread = std::sqrt(solution.variance_factor);
  std::vector<Eigen::VectorXd> values(static_cast<std::size_t>(samples));
  std::atomic<int> next{0};
  std::exception_ptr fault;
  std::atomic<bool> failed{false};
  const auto work = [&] {
    try {
      for (int k = next++; k < samples && !failed; k = next++) {
        std::mt19937_64 random(options.seed * 0x9E3779B97F4A7C15ULL +
                               static_cast<std::uint64_t>(k));
        std::normal_distribution<double> normal;
        UpdateProblem problem(states, free, options);
        for (const auto& pair : solution.pairs) {
          const double s = spread * problem.relative_std(pair.state, pair.measured);
          const auto& measured = states[static_cast<std::size_t>(pair.state)]
                                     .measured[static_cast<std::size_t>(pair.measured)];
          const double damping_std = std::isfinite(measured.damping_ratio.std)
                                         ? measured.damping_ratio.std / measured.damping_ratio.value
                                         : options.assumed_damping_relative_std;
          const double frequency = pair.model_hz * std::exp(s * normal(random));
          const double damping = pair.model_damping * std::exp(damping_std * normal(random));
          problem.set_measured(pair.state, pair.measured, frequency, damping);
        }
        if (problem.has_frfs() &&
            !problem.redraw_frfs(solution.coordinates, spread, [&] { return normal(random); })) {
          continue;
        }
        for (Eigen::Index j = 0; j < n; ++j) {
          const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
          if (coordinate.prior_std > 0) {
            problem.set_prior(j, solution.coordinates[j] + coordinate.prior_std * normal(random));
          }
        }
        Eigen::VectorXd q = solution.coordinates;
        double cost = 0;
        if (minimise(problem, matches, UpdateStage::full, options, q, cost)) {
          Eigen::VectorXd value(n);
          for (Eigen::Index j = 0; j < n; ++j) {
            value[j] = problem.coordinates()[static_cast<std::size_t>(j)].value(q[j]);
          }
          values[static_cast<std::size_t>(k)] = std::move(value);
        }
        if (progress) progress();
      }
    } catch (...) {
      if (!failed.exchange(true)) fault = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  for (int t = 1; t < options.threads; ++t) threads.emplace_back(work);
  work();
  for (auto& thread : threads) thread.join();
  if (fault) std::rethrow_exception(fault);

  std::erase_if(values, [](const auto& value) { return value.size() == 0; });
  result.samples = static_cast<int>(values.size());
  result.failed = samples - result.samples;
  if (result.samples < 2) return result;
  result.values.resize(n, result.samples);
  for (int k = 0; k < result.samples; ++k) {
    result.values.col(k) = values[static_cast<std::size_t>(k)];
  }
  result.mean = result.values.rowwise().mean();
  result.std =
      ((result.values.colwise() - result.mean).rowwise().squaredNorm() / (result.samples - 1.0))
          .cwiseSqrt();
  result.low.resize(n), result.high.resize(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    Eigen::VectorXd sorted = result.values.row(j);
    std::sort(sorted.begin(), sorted.end());
    const auto at = [&](double p) {
      return sorted[static_cast<Eigen::Index>(std::lround(p * (result.samples - 1)))];
    };
    result.low[j] = at(0.025);
    result.high[j] = at(0.975);
  }
  return result;
}

}  // namespace rigfit::ident
