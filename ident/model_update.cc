#include "ident/model_update.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <random>
#include <stdexcept>
#include <thread>

#include "ident/update_problem.h"

namespace rigfit::ident {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Huber's rho as a change of the residual: r~ with r~^2 = rho(r^2), so that the minimiser sees
// plain squares of smooth functions.
double huber(double r, double k, double& derivative) {
  if (std::abs(r) <= k) {
    derivative = 1;
    return r;
  }
  const double root = std::sqrt(2 * k * std::abs(r) - k * k);
  derivative = k / root;
  return std::copysign(root, r);
}

class UpdateCost : public ceres::CostFunction {
 public:
  UpdateCost(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
             double threshold)
      : problem_(problem), matches_(matches), threshold_(threshold) {
    set_num_residuals(static_cast<int>(problem.residual_count(matches)));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.size()));
  }
  bool Evaluate(double const* const* blocks, double* out, double** jacobians) const override {
    const Eigen::Map<const Eigen::VectorXd> q(blocks[0], problem_.size());
    const bool derivatives = jacobians != nullptr && jacobians[0] != nullptr;
    Eigen::VectorXd r;
    Eigen::MatrixXd J;
    if (!problem_.residuals(q, matches_, r, derivatives ? &J : nullptr)) return false;
    const Eigen::Index data = r.size() - problem_.prior_count();
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      double factor = 1;
      out[i] = i < data ? huber(r[i], threshold_, factor) : r[i];
      if (!derivatives) continue;
      for (Eigen::Index j = 0; j < J.cols(); ++j) {
        jacobians[0][i * J.cols() + j] = factor * J(i, j);
      }
    }
    return true;
  }

 private:
  const UpdateProblem& problem_;
  const std::vector<UpdateMatch>& matches_;
  double threshold_;
};

struct Solved {
  Eigen::VectorXd q;
  UpdateMatches matches;
  double cost = std::numeric_limits<double>::infinity();
  bool converged = false;
  int pairings = 0;
  std::string failure;
};

// What a mode that finds no partner adds to the cost: as much as one 20 % off.
double unpaired_cost(const UpdateOptions& options) {
  double ignored;
  const double far = 0.2 / std::hypot(options.assumed_relative_std, options.model_relative_std);
  return 0.5 * std::pow(huber(far, options.huber_threshold, ignored), 2);
}

// A cost that is nothing but rounding: data without noise, fitted exactly.
double negligible_cost(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches) {
  return 1e-10 * static_cast<double>(problem.residual_count(matches));
}

// With fixed pairs.
bool minimise(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
              const UpdateOptions& options, Eigen::VectorXd& q, double& cost) {
  ceres::Problem::Options ownership;
  ceres::Problem ceres_problem(ownership);
  ceres_problem.AddResidualBlock(new UpdateCost(problem, matches, options.huber_threshold), nullptr,
                                 q.data());
  const auto& coordinates = problem.coordinates();
  for (int j = 0; j < static_cast<int>(coordinates.size()); ++j) {
    const auto& coordinate = coordinates[static_cast<std::size_t>(j)];
    if (std::isfinite(coordinate.low)) {
      ceres_problem.SetParameterLowerBound(q.data(), j, coordinate.low);
    }
    if (std::isfinite(coordinate.high)) {
      ceres_problem.SetParameterUpperBound(q.data(), j, coordinate.high);
    }
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.logging_type = ceres::SILENT;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = 1e-9;
  solver.parameter_tolerance = 1e-9;
  solver.gradient_tolerance = 1e-9;
  // What the pairs leave open would otherwise run off along its valley.
  solver.min_lm_diagonal = 1e-4;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &ceres_problem, &summary);
  if (!summary.IsSolutionUsable()) return false;
  cost = summary.final_cost;
  // Data without noise: the cost goes on falling by large factors when nothing is left of it.
  return summary.termination_type == ceres::CONVERGENCE || cost < negligible_cost(problem, matches);
}

Solved solve_from(const UpdateProblem& problem, Eigen::VectorXd q, const UpdateOptions& options) {
  Solved best;
  std::vector<std::vector<UpdateMatch>> seen;
  std::string failure;
  UpdateMatches matches = problem.match(q, options.first_common_factor, failure);
  for (int pass = 0; pass < options.max_pairings; ++pass) {
    ++best.pairings;
    if (!failure.empty()) {
      if (best.q.size() == 0) best.failure = failure;
      break;
    }
    if (matches.matches.empty()) {
      if (best.q.size() == 0) best.failure = "no measured mode lies near any modelled one";
      break;
    }
    seen.push_back(matches.matches);
    double cost = 0;
    const bool converged = minimise(problem, matches.matches, options, q, cost);
    UpdateMatches next = problem.match(q, 1, failure);
    if (!failure.empty()) break;
    // The cost of this answer counts the pairs it really has.
    double total = unpaired_cost(options) * next.unpaired_measured;
    Eigen::VectorXd r;
    if (!problem.residuals(q, next.matches, r, nullptr)) break;
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      double ignored;
      const bool data = i < r.size() - problem.prior_count();
      total += 0.5 * std::pow(data ? huber(r[i], options.huber_threshold, ignored) : r[i], 2);
    }
    const bool settled = next.matches == matches.matches;
    // Pairs that stay confirm an answer that an earlier pass had already reached to rounding.
    const bool confirmed = settled && total <= best.cost + negligible_cost(problem, next.matches);
    if (total < best.cost || confirmed) {
      best.q = q;
      best.matches = next;
      best.cost = total;
      best.converged = converged && settled;
    }
    if (settled || std::find(seen.begin(), seen.end(), next.matches) != seen.end()) break;
    matches = std::move(next);
  }
  return best;
}

std::vector<Eigen::VectorXd> starts_of(const UpdateProblem& problem, const UpdateOptions& options) {
  std::vector<Eigen::VectorXd> starts{problem.start()};
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int k = 1; k < options.starts; ++k) {
    Eigen::VectorXd q = problem.start();
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
      const double u = uniform(random);
      // Lengths are never off by a factor: a tenth; what has a prior moves within it.
      double reach = coordinate.logarithmic ? std::log(options.start_spread) : 0.1;
      if (coordinate.prior_std > 0) reach = std::min(reach, 2 * coordinate.prior_std);
      q[j] = std::clamp(q[j] + reach * u, coordinate.low, coordinate.high);
    }
    starts.push_back(std::move(q));
  }
  return starts;
}

// Weighted Jacobian at the solution, Huber's weights included; the priors' rows last.
bool weighted(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
              const UpdateOptions& options, const Eigen::VectorXd& q, Eigen::VectorXd& r,
              Eigen::MatrixXd& J) {
  if (!problem.residuals(q, matches, r, &J)) return false;
  for (Eigen::Index i = 0; i < r.size() - problem.prior_count(); ++i) {
    const double weight =
        std::min(1.0, std::sqrt(options.huber_threshold / std::max(std::abs(r[i]), 1e-300)));
    r[i] *= weight;
    J.row(i) *= weight;
  }
  return true;
}

void state_uncertainty(const UpdateProblem& problem, const UpdateOptions& options,
                       UpdateResult& result, const std::vector<UpdateMatch>& matches) {
  const Eigen::Index n = problem.size();
  const Eigen::VectorXd& q = result.coordinates;
  Eigen::VectorXd r;
  Eigen::MatrixXd J;
  result.covariance = Eigen::MatrixXd::Constant(n, n, kNaN);
  if (!weighted(problem, matches, options, q, r, J)) return;
  const Eigen::Index data = r.size() - problem.prior_count();
  result.chi_squared = r.squaredNorm();
  result.degrees_of_freedom = static_cast<double>(r.size() - n);
  const double reduced =
      result.degrees_of_freedom > 0 ? result.chi_squared / result.degrees_of_freedom : kNaN;
  // Stated uncertainties are trusted unless the scatter contradicts them; assumed ones are not.
  const bool stated = problem.uncertainties_known();
  if (stated) {
    result.variance_factor = reduced > 1 ? reduced : 1;
  } else {
    result.variance_factor = std::isfinite(reduced) ? reduced : 1;
  }
  const bool from_scatter = !stated && std::isfinite(reduced);
  result.coverage_factor = coverage_factor(0.95, from_scatter ? result.degrees_of_freedom : 0);
  if (!stated && !std::isfinite(reduced)) {
    result.message +=
        "no more data than unknowns: uncertainties rest on the assumed one of the "
        "frequencies; ";
  }

  Eigen::VectorXd scales = Eigen::VectorXd::Ones(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    if (!problem.coordinates()[static_cast<std::size_t>(j)].logarithmic) {
      scales[j] = std::max(1.0, std::abs(q[j]));
    }
  }
  IdentifiabilityOptions limits;
  limits.relative_rank_tolerance = 1e-8;
  limits.variance_factor = std::max(result.variance_factor, 1e-12);
  const auto names = problem.names();
  result.identifiability = identifiability(J, scales, names, limits);
  const auto alone = identifiability(J.topRows(data), scales, names, limits);
  for (const auto& open : result.identifiability.open) result.open.push_back(open.message);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(i)];
    auto& parameter = result.parameters[static_cast<std::size_t>(i)];
    const double by = coordinate.derivative(q[i]);
    parameter.identifiable = result.identifiability.identifiable[static_cast<std::size_t>(i)];
    parameter.std = std::abs(by) * result.identifiability.std[i];
    parameter.std_from_data = std::abs(by) * alone.std[i];
    parameter.at_bound = q[i] <= coordinate.low + 1e-9 || q[i] >= coordinate.high - 1e-9;
    for (Eigen::Index j = 0; j < n; ++j) {
      result.covariance(i, j) = by * result.identifiability.covariance(i, j) *
                                problem.coordinates()[static_cast<std::size_t>(j)].derivative(q[j]);
    }
  }
}

std::vector<Solved> solve_all(const UpdateProblem& problem, const UpdateOptions& options) {
  const auto starts = starts_of(problem, options);
  std::vector<Solved> solved(starts.size());
  std::vector<std::exception_ptr> faults(starts.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t k = next++; k < starts.size(); k = next++) {
      try {
        solved[k] = solve_from(problem, starts[k], options);
      } catch (...) {
        faults[k] = std::current_exception();
      }
    }
  };
  std::vector<std::thread> threads;
  for (int t = 1; t < std::min<int>(options.threads, static_cast<int>(starts.size())); ++t) {
    threads.emplace_back(work);
  }
  work();
  for (auto& thread : threads) thread.join();
  for (const auto& fault : faults) {
    if (fault) std::rethrow_exception(fault);
  }
  return solved;
}

}  // namespace

const char* name_of(UpdateStatus status) {
  switch (status) {
    case UpdateStatus::converged:
      return "converged";
    case UpdateStatus::not_converged:
      return "not converged";
    case UpdateStatus::no_model:
      return "no model";
    case UpdateStatus::too_little_data:
      return "too little data";
  }
  return "not converged";
}

UpdateResult update_problem_result(const UpdateProblem& problem, const UpdateOptions& options) {
  UpdateResult result;
  const auto& coordinates = problem.coordinates();
  if (coordinates.empty()) throw std::invalid_argument("update: no free parameter");
  const Eigen::VectorXd start = problem.start();
  const auto names = problem.names();
  for (std::size_t j = 0; j < coordinates.size(); ++j) {
    const double value = coordinates[j].value(start[static_cast<Eigen::Index>(j)]);
    result.parameters.push_back({.name = names[j],
                                 .state = coordinates[j].state,
                                 .start = value,
                                 .value = value,
                                 .std = kNaN,
                                 .std_from_data = kNaN});
  }
  result.rms_relative_error = result.rms_relative_error_before = kNaN;
  std::string failure;
  const UpdateMatches before = problem.match(start, 1, failure);
  if (failure.empty()) {
    result.pairs_before = problem.pairs(start, before.matches);
    result.rms_relative_error_before = rms_of_pairs(result.pairs_before);
  }

  const auto solved = solve_all(problem, options);
  const Solved* best = nullptr;
  for (const auto& one : solved) {
    result.pairings += one.pairings;
    if (one.q.size() > 0 && (best == nullptr || one.cost < best->cost)) best = &one;
  }
  result.starts = static_cast<int>(solved.size());
  if (best == nullptr) {
    result.status = UpdateStatus::no_model;
    result.message = "from no start could the model be fitted: " + solved.front().failure;
    result.model_evaluations = problem.evaluations();
    return result;
  }
  result.coordinates = best->q;
  for (const auto& one : solved) {
    // The same answer: a cost that differs by less than what a hundredth of a standard deviation
    // in one residual makes.
    result.starts_agreeing += one.q.size() > 0 && one.cost <= best->cost * (1 + 1e-4) + 1e-4;
  }
  for (std::size_t j = 0; j < coordinates.size(); ++j) {
    result.parameters[j].value = coordinates[j].value(best->q[static_cast<Eigen::Index>(j)]);
  }
  result.status = best->converged ? UpdateStatus::converged : UpdateStatus::not_converged;
  if (!best->converged) {
    result.message =
        "the fit or its pairs had not settled; what is given is the best that was "
        "seen; ";
  }
  if (static_cast<Eigen::Index>(coordinates.size()) >
      problem.residual_count(best->matches.matches)) {
    result.status = UpdateStatus::too_little_data;
    result.message += fmt::format("{} unknowns and {} data; ", coordinates.size(),
                                  problem.residual_count(best->matches.matches));
  }
  result.pairs = problem.pairs(best->q, best->matches.matches);
  result.unpaired = best->matches.unpaired;
  result.rms_relative_error = rms_of_pairs(result.pairs);
  state_uncertainty(problem, options, result, best->matches.matches);
  for (int s = 0; s < static_cast<int>(problem.states().size()); ++s) {
    result.scenes.push_back(problem.scene_at(s, best->q));
  }
  result.model_evaluations = problem.evaluations();
  if (result.message.ends_with("; ")) result.message.resize(result.message.size() - 2);
  return result;
}

UpdateResult update_model(const std::vector<UpdateState>& states,
                          const std::vector<FreeParameter>& free, const UpdateOptions& options) {
  return update_problem_result(UpdateProblem(states, free, options), options);
}

PairedModes compare_with_measured(const std::vector<UpdateState>& states,
                                  const UpdateOptions& options) {
  const UpdateProblem problem(states, {}, options);
  PairedModes result;
  std::string failure;
  const auto matches = problem.match(Eigen::VectorXd(), 1, failure);
  if (!failure.empty()) return result;
  result.pairs = problem.pairs(Eigen::VectorXd(), matches.matches);
  result.unpaired = matches.unpaired;
  result.rms_relative_error = rms_of_pairs(result.pairs);
  return result;
}

std::vector<HeldOut> hold_out_each(const std::vector<UpdateState>& states,
                                   const std::vector<FreeParameter>& free,
                                   const UpdateOptions& options) {
  std::vector<HeldOut> result;
  for (int s = 0; s < static_cast<int>(states.size()); ++s) {
    HeldOut held;
    held.state = s;
    held.rms_fitted = held.rms_predicted = held.rms_before = kNaN;
    const UpdateProblem problem(states, free, options, s);
    const UpdateResult fitted = update_problem_result(problem, options);
    held.status = fitted.status;
    std::string failure;
    const auto before = problem.match(problem.start(), 1, failure, s);
    if (failure.empty())
      held.rms_before = rms_of_pairs(problem.pairs(problem.start(), before.matches));
    if (fitted.coordinates.size() > 0) {
      held.rms_fitted = fitted.rms_relative_error;
      // Its own values, where a parameter has one a state, stay as they were known before.
      Eigen::VectorXd q = fitted.coordinates;
      for (Eigen::Index j = 0; j < q.size(); ++j) {
        const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
        if (coordinate.state == s) q[j] = coordinate.start;
      }
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
        for (Eigen::Index j = 0; j < n; ++j) {
          const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
          if (coordinate.prior_std > 0) {
            problem.set_prior(j, solution.coordinates[j] + coordinate.prior_std * normal(random));
          }
        }
        Eigen::VectorXd q = solution.coordinates;
        double cost = 0;
        if (minimise(problem, matches, options, q, cost)) {
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
