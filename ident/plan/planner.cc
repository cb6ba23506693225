#include "ident/plan/plan.h"

#include <fmt/ranges.h>

#include "ident/plan/plan_candidates.h"

namespace rigfit::ident {
namespace {

using Tests = std::vector<PlanTest>;

// Share of the best that can be had, where that misses a goal: further steps cost much and add
// little.
constexpr double kNearBest = 1.05;
// Least decrease of the sum of ln(std / goal): 1 % of a std is not worth a step. Far from the
// goals, by a factor of e, the first of two steps may show little beyond rounding.
constexpr double kLeastGain = 0.01, kFarFromGoals = 1, kNoGain = 1e-6;

// To better than itself, as in an update.
bool is_determined(double variance) { return variance <= kMaxRelativeStd * kMaxRelativeStd; }

// A step: the tests after it, and the one that it adds or changes.
struct Move {
  Tests tests;
  std::size_t changed = 0;
};

// All hammers in all states with all sensors at once, as often and as long as allowed.
Tests all_tests(const PlanCandidates& candidates) {
  const auto& options = candidates.options;
  PlanTest test{0, 0, {}, options.hits.size() - 1, options.durations_s.size() - 1};
  for (std::size_t k = 0; k < candidates.sensors.size(); ++k) test.sensors.push_back(k);
  Tests tests;
  for (test.state = 0; test.state < candidates.states.size(); ++test.state) {
    for (test.load = 0; test.load < candidates.loads.size(); ++test.load) tests.push_back(test);
  }
  return tests;
}

class Planner {
 public:
  /// `targets`: coordinates of the goals, and the std to be reached.
  Planner(const PlanCandidates& candidates, std::vector<std::pair<Index, double>> targets)
      : candidates_(candidates), targets_(std::move(targets)) {}

  [[nodiscard]] MatrixXd covariance(const Tests& tests) const {
    return plan_covariance(candidates_, planned_modes(candidates_, tests));
  }

  /// Sum of ln(std / target) of the goals that are not reached.
  [[nodiscard]] double shortfall(const Tests& tests) const {
    const auto C = covariance(tests);
    double sum = 0;
    for (const auto& [i, target] : targets_) {
      sum += std::max(0.0, 0.5 * std::log(C(i, i)) - std::log(target));
    }
    return sum;
  }

  /// On the rig, s: records, 60 s for each place of hammer or sensor, 600 s for each state
  /// (tension, length) other than the first.
  [[nodiscard]] double cost(const Tests& tests) const {
    double sum = 0;
    std::set<std::size_t> visited{0};
    for (const auto& test : tests) {
      sum += options_.hits[test.hits] * options_.durations_s[test.duration] +
             60 * (1 + static_cast<double>(test.sensors.size()));
      if (visited.insert(test.state).second) sum += 600;
    }
    return sum;
  }

  /// Greedy steps until the targets are reached or no step helps.
  [[nodiscard]] std::vector<Move> steps() const {
    std::vector<Move> taken;
    Tests now;
    for (;;) {
      const double left = shortfall(now);
      if (left <= 0) return taken;
      Move best;
      double best_rate = -std::numeric_limits<double>::infinity(), gain = 0;
      for (auto& move : moves(now)) {
        const double less = left - shortfall(move.tests);
        const double rate = less / std::max(cost(move.tests) - cost(now), 1.0);
        if (rate > best_rate) best_rate = rate, gain = less, best = std::move(move);
      }
      const double least = left > kFarFromGoals ? kNoGain : kLeastGain;
      if (best.tests.empty() || gain < least) return taken;
      now = best.tests;
      taken.push_back(std::move(best));
    }
  }

 private:
  [[nodiscard]] std::vector<Move> moves(const Tests& now) const {
    std::vector<Move> list;
    for (const auto& limit : all_tests(candidates_)) {
      const auto here = std::find_if(now.begin(), now.end(), [&](const PlanTest& test) {
        return test.state == limit.state && test.load == limit.load;
      });
      const auto at = static_cast<std::size_t>(here - now.begin());
      const auto add = [&](const auto& change) {
        list.push_back({now, at});
        if (here == now.end()) {
          list.back().tests.push_back({limit.state, limit.load, {}, 0, 0});
        }
        change(list.back().tests[at]);
      };
      for (const auto sensor : limit.sensors) {
        if (here != now.end() && (std::ssize(here->sensors) >= options_.sensors ||
                                  std::ranges::count(here->sensors, sensor) > 0)) {
          continue;
        }
        add([&](PlanTest& test) { test.sensors.push_back(sensor); });
      }
      if (here == now.end()) continue;
      if (here->hits < limit.hits) add([](PlanTest& test) { ++test.hits; });
      if (here->duration < limit.duration) add([](PlanTest& test) { ++test.duration; });
    }
    return list;
  }

  const PlanCandidates& candidates_;
  const PlanOptions& options_ = candidates_.options;
  std::vector<std::pair<Index, double>> targets_;
};

std::string text_of(const PlanTest& test, const PlanCandidates& candidates) {
  std::vector<std::string> sensors;
  for (const auto sensor : test.sensors) sensors.push_back(candidates.sensors[sensor].name);
  const auto modes = planned_modes(candidates, {test});
  double highest = 0;
  for (const auto& mode : modes) highest = std::max(highest, mode.frequency_hz);
  return fmt::format("{}: {}, read {}, {} mode{} to {:.4g} Hz, {} hits of {:g} s",
                     candidates.problem.states()[test.state].name, candidates.loads[test.load].name,
                     fmt::join(sensors, " + "), modes.size(), modes.size() == 1 ? "" : "s", highest,
                     candidates.options.hits[test.hits],
                     candidates.options.durations_s[test.duration]);
}

// Parameters whose value differs between the states become one per state.
void part_by_state(const std::vector<UpdateState>& states, std::vector<FreeParameter>& free) {
  for (auto& parameter : free) {
    const auto target = parameter.all_targets().front();
    const double own = model::parameter(states.front().scene, target);
    if (std::ranges::all_of(states, [&](const auto& state) {
          return model::parameter(state.scene, target) == own;
        })) {
      continue;
    }
    parameter.per_state = true;
    if (!parameter.prior) continue;
    parameter.prior_relative_std = parameter.prior->std / std::abs(parameter.prior->value);
    parameter.prior.reset();
  }
}

double by_coordinate(const PlanCandidates& candidates, Index i) {
  return std::abs(
      candidates.problem.coordinates()[static_cast<std::size_t>(i)].derivative(candidates.q[i]));
}

std::vector<PlannedStd> planned_stds(const PlanCandidates& candidates, const MatrixXd& C) {
  const auto names = candidates.problem.names();
  std::vector<PlannedStd> stds;
  for (Index i = 0; i < C.rows(); ++i) {
    const auto j = static_cast<std::size_t>(i);
    stds.push_back(
        {names[j], candidates.problem.coordinates()[j].value(candidates.q[i]),
         is_determined(C(i, i)) ? by_coordinate(candidates, i) * std::sqrt(C(i, i)) : kNaN});
  }
  return stds;
}

PlannedGoal planned_goal(const PlanCandidates& candidates, const std::vector<FreeParameter>& free,
                         const PlanGoal& goal) {
  const auto& coordinates = candidates.problem.coordinates();
  const auto last = coordinates.begin() + candidates.problem.parameter_count();
  const auto at = std::find_if(coordinates.begin(), last, [&](const auto& one) {
    return free[static_cast<std::size_t>(one.parameter)].name == goal.parameter;
  });
  if (at == last || !(goal.std > 0) || !std::isfinite(goal.std)) {
    throw std::invalid_argument("the goal " + goal.parameter +
                                " is no free parameter or not positive");
  }
  const auto i = at - coordinates.begin();
  const double unit = goal.relative ? std::abs(at->value(candidates.q[i])) : 1;
  return {goal, static_cast<std::size_t>(i), goal.std * unit, false, ""};
}

// What no measurement determines: the null space of all data, without priors.
std::vector<OpenDirection> plan_gaps(const PlanCandidates& candidates,
                                     const std::vector<PlannedMode>& modes) {
  const Index n = candidates.problem.parameter_count();
  auto names = candidates.problem.names();
  names.resize(static_cast<std::size_t>(n));
  const MatrixXd rows = plan_rows(candidates, modes).leftCols(n);
  return identifiability(rows, VectorXd::Ones(n), names).open;
}

// What would reach a goal that the plan misses. `least`: covariance with everything measured.
std::string what_it_takes(const PlanCandidates& candidates, const PlannedGoal& goal,
                          const MatrixXd& least) {
  const auto i = static_cast<Index>(goal.parameter);
  const double wanted = goal.wanted_std / by_coordinate(candidates, i);
  const double excess = least(i, i) - wanted * wanted;
  if (excess <= 0) {
    const bool inputs = candidates.problem.size() > candidates.problem.parameter_count();
    return std::string("allow more sensors, hits or longer records") +
           (inputs ? ", or know the uncertain inputs better" : "");
  }
  // A prior of variance v on parameter j lowers the variance by c^2 / (var_j + v). One that is
  // wider than the value says nothing, and the condition is then rounding.
  Index easiest = -1;
  double widest = 0;
  for (Index j = 0; j < least.rows(); ++j) {
    const double prior = least(i, j) * least(i, j) / excess - least(j, j);
    if (j != i && prior > widest && is_determined(prior)) easiest = j, widest = prior;
  }
  if (easiest >= 0) {
    return fmt::format("give a prior: {} known to {:.2g} by another test",
                       candidates.problem.names()[static_cast<std::size_t>(easiest)],
                       std::sqrt(widest) * by_coordinate(candidates, easiest));
  }
  return is_determined(least(i, i))
             ? fmt::format(
                   "add tensions or lengths, or make the frequencies {:.1f} times more "
                   "accurate, model included",
                   std::sqrt(least(i, i)) / wanted)
             : "add tensions or lengths, or priors of other parameters";
}

}  // namespace

std::vector<UpdateState> plan_states(const model::Scene& scene,
                                     const std::vector<double>& tensions_N,
                                     const std::vector<double>& lengths_m) {
  const auto tensioned =
      std::find_if(scene.members.begin(), scene.members.end(),
                   [](const auto& member) { return member.tension.has_value(); });
  if (!tensions_N.empty() && tensioned == scene.members.end()) {
    throw std::invalid_argument("other tensions need a cable whose tension the scene gives");
  }
  const auto& first = scene.members.front();
  if (!lengths_m.empty() &&
      (scene.members.size() != 1 || first.unstretched_length || first.stretch)) {
    throw std::invalid_argument(
        "other lengths need a scene of one member with no length of its own");
  }
  std::vector<std::optional<double>> tensions{std::nullopt}, lengths{std::nullopt};
  tensions.insert(tensions.end(), tensions_N.begin(), tensions_N.end());
  lengths.insert(lengths.end(), lengths_m.begin(), lengths_m.end());
  std::vector<UpdateState> states;
  for (const auto& length : lengths) {
    for (const auto& tension : tensions) {
      if (tension && tension == tensioned->tension) continue;  // as drawn
      UpdateState state{tension ? fmt::format("{:g} N", *tension) : "as drawn", scene, {}};
      for (auto& member : state.scene.members) {
        if (member.tension && tension) member.tension = tension;
      }
      if (length) {
        const auto node = [&](std::size_t end) {
          return std::find_if(state.scene.nodes.begin(), state.scene.nodes.end(),
                              [&](const auto& one) { return one.name == first.nodes[end]; });
        };
        const Vector3d from = node(0)->position, along = node(1)->position - from;
        node(1)->position = from + *length * along.normalized();
        state.name += fmt::format(", {:g} m", *length);
      }
      states.push_back(std::move(state));
    }
  }
  return states;
}

PlanResult plan_measurements(const std::vector<UpdateState>& states,
                             std::vector<FreeParameter> free, const std::vector<PlanGoal>& goals,
                             const PlanOptions& options) {
  part_by_state(states, free);
  const PlanCandidates candidates = plan_candidates(states, free, options);
  PlanResult result;
  result.failure = candidates.states.front().failure;
  if (!result.failure.empty()) return result;
  for (std::size_t s = 1; s < states.size(); ++s) {
    const auto& failure = candidates.states[s].failure;
    if (!failure.empty()) result.left_out.push_back(states[s].name + ": " + failure);
  }
  const Tests everything = all_tests(candidates);
  const auto all_modes = planned_modes(candidates, everything);
  const MatrixXd least = plan_covariance(candidates, all_modes);
  result.not_identifiable = plan_gaps(candidates, all_modes);
  std::vector<std::pair<Index, double>> targets;
  for (const auto& one : goals) {
    const auto goal = planned_goal(candidates, free, one);
    const auto i = static_cast<Index>(goal.parameter);
    targets.emplace_back(i, std::max(goal.wanted_std / by_coordinate(candidates, i),
                                     kNearBest * std::sqrt(least(i, i))));
    result.goals.push_back(goal);
  }
  const Planner planner(candidates, std::move(targets));
  Tests now;
  const auto before = planned_stds(candidates, planner.covariance(now));
  for (const auto& move : planner.steps()) {
    result.proposals.push_back({text_of(move.tests[move.changed], candidates),
                                planner.cost(move.tests) - planner.cost(now),
                                planned_stds(candidates, planner.covariance(move.tests))});
    now = move.tests;
  }
  const auto after = planned_stds(candidates, planner.covariance(now)),
             best = planned_stds(candidates, least);
  for (std::size_t j = 0; j < before.size(); ++j) {
    result.parameters.push_back({after[j], before[j].std, best[j].std});
  }
  for (auto& goal : result.goals) {
    goal.reached = after[goal.parameter].std <= goal.wanted_std;
    if (!goal.reached) goal.takes = what_it_takes(candidates, goal, least);
  }
  result.modes = planned_modes(candidates, now);
  return result;
}

}  // namespace rigfit::ident
