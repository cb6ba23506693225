#include "ident/update/uncertainty/update_intervals.h"

#include <algorithm>
#include <cmath>

#include "ident/statistics/root.h"
#include "ident/update/problem/update_solver.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;

constexpr double kCurved = 0.12;    // in the root of the deviance: a quarter of the deviance
constexpr double kStraight = 0.03;  // standard uncertainty in q below which models are linear
constexpr double kProfiled = 0.01;  // tolerance, root of the deviance

// How far the deviance is above the solution's, as a standard normal would have it.
double signed_root(double cost, double least, double variance_factor) {
  return std::sqrt(std::max(0.0, 2 * (cost - least) / variance_factor));
}

bool at_bound(const UpdateCoordinate& coordinate, double q, double reach) {
  return q - reach <= coordinate.low || q + reach >= coordinate.high;
}

// One end of the profile interval of coordinate j, in q; NaN: the cost stays below.
double profile_end(const UpdateProblem& problem, const UpdateOptions& given,
                   const std::vector<UpdateMatch>& matches, const UpdateResult& solution,
                   Eigen::Index j, double direction, double least) {
  UpdateOptions options = given;
  // A cost of 200 to 0.02: with a deviance of k^2, about 4, the root is then known to kProfiled.
  options.function_tolerance = std::max(given.function_tolerance, 1e-4);
  const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
  const double goal = solution.coverage_factor;
  const double at = solution.coordinates[j];
  const double bound = direction > 0 ? coordinate.high : coordinate.low;
  const double own = solution.identifiability.std[j];
  // The root of the deviance is nearly a straight line in q: secants on it from the linear answer.
  double near = 0, near_root = 0, step = std::isfinite(own) ? goal * own : 0.5;
  Eigen::VectorXd q = solution.coordinates;
  const auto root_at = [&](double place) {
    q[j] = place;
    double cost = 0;
    (void)minimise(problem, matches, options, q, cost, static_cast<int>(j));
    const bool found = cost_of(problem, matches, q, cost);
    return found ? signed_root(cost, least, solution.variance_factor) : kNaN;
  };
  if (!std::isfinite(own) && std::isfinite(bound)) {  // often open up to the bound
    if (root_at(bound) < goal) return kNaN;
    q = solution.coordinates;
  }
  for (int round = 0; round < 12; ++round) {
    if (std::abs(bound - at) < step) step = std::abs(bound - at);
    const double root = root_at(at + direction * step);
    if (std::isnan(root)) return kNaN;
    if (std::abs(root - goal) < kProfiled * goal) return q[j];
    if (root < goal && q[j] == bound) return kNaN;
    const double slope = (root - near_root) / (step - near);
    const double next = slope > 0 ? step + (goal - root) / slope : 2 * step;
    near = step, near_root = root;
    step = std::clamp(next, 0.2 * step, 3 * step);
  }
  return kNaN;
}

// Whether the cost is no parabola between the linear ends of coordinate j.
bool is_curved(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
               const UpdateResult& result, Eigen::Index j, double least) {
  const auto& known = result.identifiability;
  const double k = result.coverage_factor, std = known.std[j];
  Eigen::VectorXd along = known.covariance.col(j) * (k / std);
  for (double& step : along) step = std::isfinite(step) ? step : 0;
  for (const double sign : {-1.0, 1.0}) {
    Eigen::VectorXd q = result.coordinates + sign * along;
    double cost = 0;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(i)];
      if (q[i] <= coordinate.low || q[i] >= coordinate.high) return true;
    }
    if (!cost_of(problem, matches, q, cost)) return true;
    const double root = signed_root(cost, least, result.variance_factor);
    if (std::abs(root / k - 1) > kCurved) return true;
  }
  return false;
}

}  // namespace

void state_intervals(const UpdateProblem& problem, const UpdateOptions& options,
                     const std::vector<UpdateMatch>& matches, UpdateResult& result) {
  const auto& known = result.identifiability;
  const Eigen::Index n = problem.parameter_count();
  if (known.std.size() != problem.size()) return;
  double least = 0;
  const bool costs = options.intervals && problem.modes_only() &&
                     cost_of(problem, matches, result.coordinates, least);
  bool loose = false;
  for (const auto& parameter : result.parameters) {
    loose = loose || parameter.at_bound || !parameter.identifiable;
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
    auto& parameter = result.parameters[static_cast<std::size_t>(j)];
    const double q = result.coordinates[j];
    const double by = std::abs(coordinate.derivative(q));
    double low = kNaN, high = kNaN;
    parameter.interval_by_profile = false;
    if (parameter.identifiable && std::isfinite(parameter.std)) {
      const double half = result.coverage_factor * parameter.std / by;
      low = q - half, high = q + half;
      const bool checked =
          costs && (loose || known.std[j] > kStraight || at_bound(coordinate, q, half));
      parameter.interval_by_profile =
          checked && (loose || is_curved(problem, matches, result, j, least));
    } else {
      parameter.interval_by_profile = costs;
    }
    if (parameter.interval_by_profile) {
      // What is not in the profile: errors that modes share.
      const double own = std::isfinite(known.std[j]) ? known.std[j] : 0;
      const double all = std::isfinite(parameter.std) ? parameter.std / by : 0;
      const double more = result.coverage_factor * std::sqrt(std::max(0.0, all * all - own * own));
      const double one = profile_end(problem, options, matches, result, j, -1, least);
      const double other = profile_end(problem, options, matches, result, j, 1, least);
      low = q - std::hypot(q - one, more), high = q + std::hypot(other - q, more);
    }
    const auto value = [&](double at) { return std::isfinite(at) ? coordinate.value(at) : kNaN; };
    parameter.low = value(low), parameter.high = value(high);
    if (coordinate.derivative(q) < 0) std::swap(parameter.low, parameter.high);
    // The standard uncertainty and its budget follow a closed profile.
    const double width = (parameter.high - parameter.low) / (2 * result.coverage_factor);
    if (parameter.interval_by_profile && parameter.identifiable && std::isfinite(width)) {
      for (auto& term : parameter.budget) term.std *= width / parameter.std;
      parameter.std = width;
    }
  }
}

void state_mixture(UpdateResult& result) {
  const double k = result.coverage_factor;
  for (std::size_t p = 0; p < result.parameters.size(); ++p) {
    // Each answer a normal distribution of its interval's own halves.
    const auto below = [&](double x) {
      double sum = 0;
      for (const auto& one : result.alternatives) {
        const auto& parameter = one.parameters[p];
        const double end = x < parameter.value ? parameter.low : parameter.high;
        const double std = std::abs(end - parameter.value) / k;
        sum += one.weight * (std > 0 ? 0.5 * std::erfc((parameter.value - x) / std / std::sqrt(2.0))
                                     : (x < parameter.value ? 0 : 1));
      }
      return sum;
    };
    double least = result.parameters[p].value, most = least;
    bool closed = true;
    for (const auto& one : result.alternatives) {
      const auto& parameter = one.parameters[p];
      closed = closed && std::isfinite(parameter.low) && std::isfinite(parameter.high);
      if (!closed) break;
      least = std::min(least, parameter.value - 2 * (parameter.value - parameter.low));
      most = std::max(most, parameter.value + 2 * (parameter.high - parameter.value));
    }
    if (!closed) continue;
    // Over 1 + x - least in units of the range, which is not near zero.
    const auto quantile = [&](double goal) {
      const double range = most - least;
      const double at = root_between(
          1, 2, 1e-12, [&](double u) { return below(least + (u - 1) * range) - goal; });
      return least + (at - 1) * range;
    };
    result.parameters[p].low = quantile(0.025);
    result.parameters[p].high = quantile(0.975);
  }
}

}  // namespace rigfit::ident
