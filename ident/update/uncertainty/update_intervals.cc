#include "ident/update/uncertainty/update_uncertainty.h"

#include "ident/statistics/root.h"

namespace rigfit::ident {
namespace {

constexpr double kCurved = 0.12;    // in the root of the deviance: a quarter of the deviance
constexpr double kStraight = 0.03;  // standard uncertainty in q below which models are linear
constexpr double kProfiled = 0.01;  // tolerance, root of the deviance

// The deviance at q: squared residuals of the data over their variance factor, and those of the
// priors, which are what they say; NaN without a model there.
double deviance_at(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                   const VectorXd& q, double variance_factor) {
  VectorXd r;
  if (!problem.residuals(q, matches, r, nullptr)) return kNaN;
  const Index priors = problem.prior_count();
  return r.head(r.size() - priors).squaredNorm() / variance_factor + r.tail(priors).squaredNorm();
}

// One end of the profile interval of coordinate j, in q; NaN: the cost stays below.
double profile_end(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                   const UpdateResult& solution, Index j, double direction, double least) {
  const auto& coordinate = problem.coordinate_at(j);
  const double goal = solution.coverage_factor;
  const double at = solution.coordinates[j];
  const double bound = direction > 0 ? coordinate.high : coordinate.low;
  const double own = solution.identifiability.std[j];
  VectorXd q = solution.coordinates;
  const auto above_goal = [&](double step) {  // the root of the deviance over its goal; < 0: inside
    q[j] = at + direction * step;
    double cost = 0;
    // A cost of 200 to 0.02: with a deviance of k^2, about 4, the root is then known to kProfiled.
    (void)minimise(problem, matches, q, cost, 1e-4, static_cast<int>(j));
    const double above = deviance_at(problem, matches, q, solution.variance_factor) - least;
    return std::isnan(above) ? kNaN : std::sqrt(std::max(0.0, above)) / goal - 1;
  };
  const double farthest = std::abs(bound - at);
  if (!std::isfinite(own) && std::isfinite(bound)) {  // often open up to the bound
    if (above_goal(farthest) < 0) return kNaN;
    q = solution.coordinates;
  }
  // The root is nearly a straight line in q, but for a kink where another parameter ends.
  double inside = 0, root_inside = -1, outside = kNaN, root_outside = kNaN;
  double step = std::min(std::isfinite(own) ? goal * own : 0.5, farthest);
  for (int round = 0; round < 20; ++round) {
    const double here = above_goal(step);
    if (std::isnan(here) || (here < 0 && step == farthest)) return kNaN;
    (here < 0 ? inside : outside) = step;
    (here < 0 ? root_inside : root_outside) = here;
    if (std::abs(here) < kProfiled || outside - inside < kProfiled * step) return q[j];
    const double slope = -root_inside / (root_outside - root_inside), width = outside - inside;
    step = std::isnan(outside) ? std::min(step * std::clamp(1 / (1 + here), 1.1, 3.0), farthest)
                               : inside + width * std::clamp(slope, 0.2, 0.8);
  }
  return kNaN;
}

// Whether the cost is no parabola between the linear ends of coordinate j.
bool is_curved(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
               const UpdateResult& result, Index j, double least) {
  const auto& known = result.identifiability;
  const double k = result.coverage_factor, std = known.std[j];
  VectorXd along = known.covariance.col(j) * (k / std);
  for (double& step : along) step = std::isfinite(step) ? step : 0;
  for (const double sign : {-1.0, 1.0}) {
    const VectorXd q = result.coordinates + sign * along;
    for (Index i = 0; i < q.size(); ++i) {
      if (problem.coordinate_at(i).at_bound(q[i], 0)) return true;
    }
    const double above = deviance_at(problem, matches, q, result.variance_factor) - least;
    if (!(std::abs(std::sqrt(std::max(0.0, above)) / k - 1) <= kCurved)) return true;
  }
  return false;
}

}  // namespace

void state_intervals(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                     UpdateResult& result) {
  const auto& known = result.identifiability;
  const Index n = problem.parameter_count();
  if (known.std.size() != problem.size()) return;
  const double least = problem.modes_only() ? deviance_at(problem, matches, result.coordinates,
                                                          result.variance_factor)
                                            : kNaN;
  const bool costs = !std::isnan(least);
  bool loose = false, bent = false;  // one that may be bends the others' intervals as well
  for (Index j = 0; j < n; ++j) {
    const auto& parameter = result.parameters[static_cast<std::size_t>(j)];
    loose = loose || parameter.at_bound || !parameter.identifiable;
    bent = bent || known.std[j] > kStraight ||
           problem.coordinate_at(j).at_bound(result.coordinates[j],
                                             result.coverage_factor * known.std[j]);
  }
  for (Index j = 0; j < n; ++j) {
    const auto& coordinate = problem.coordinate_at(j);
    auto& parameter = result.parameters[static_cast<std::size_t>(j)];
    const double q = result.coordinates[j];
    const double by = std::abs(coordinate.derivative(q));
    double low = kNaN, high = kNaN;
    parameter.interval_by_profile = costs && j < problem.options().profiled;
    if (parameter.identifiable && std::isfinite(parameter.std)) {
      const double half = result.coverage_factor * parameter.std / by;
      low = q - half, high = q + half;
      parameter.interval_by_profile =
          parameter.interval_by_profile &&
          (loose || (bent && is_curved(problem, matches, result, j, least)));
    }
    if (parameter.interval_by_profile) {
      // What is not in the profile: errors that modes share.
      const double own = std::isfinite(known.std[j]) ? known.std[j] : 0;
      const double all = std::isfinite(parameter.std) ? parameter.std / by : 0;
      const double more = result.coverage_factor * std::sqrt(std::max(0.0, all * all - own * own));
      const double one = profile_end(problem, matches, result, j, -1, least);
      const double other = profile_end(problem, matches, result, j, 1, least);
      low = q - std::hypot(q - one, more), high = q + std::hypot(other - q, more);
      if (parameter.at_bound && parameter.identifiable && std::isnan(one) && std::isnan(other)) {
        parameter.identifiable = false, parameter.std = kNaN;
        result.open.push_back("the data do not determine " + parameter.name);
      }
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
    // Each answer is a normal distribution of its interval's own halves, the linear one where the
    // profile is open, and as wide as its value where nothing determines it.
    const auto half = [&](const UpdatedParameter& parameter, double end) {
      if (std::isfinite(end)) return std::abs(end - parameter.value);
      return std::isfinite(parameter.std) ? k * parameter.std : std::abs(parameter.value);
    };
    const auto below = [&](double x) {
      double sum = 0;
      for (const auto& one : result.alternatives) {
        const auto& parameter = one.parameters[p];
        const double std =
            half(parameter, x < parameter.value ? parameter.low : parameter.high) / k;
        sum += one.weight * (std > 0 ? 0.5 * std::erfc((parameter.value - x) / std / std::sqrt(2.0))
                                     : (x < parameter.value ? 0 : 1));
      }
      return sum;
    };
    double least = result.parameters[p].value, most = least;
    for (const auto& one : result.alternatives) {
      const auto& parameter = one.parameters[p];
      least += std::min(0.0, parameter.value - 2 * half(parameter, parameter.low) - least);
      most += std::max(0.0, parameter.value + 2 * half(parameter, parameter.high) - most);
    }
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
