// rigfit plan: what to measure so that parameters are known to a goal.
#include "ident/plan/plan.h"

#include "apps/campaign_file/update_data.h"
#include "apps/cli/verbs/all.h"

namespace rigfit::apps {
namespace {
using describe::std_digits;

struct PlanCommand {
  std::string scene;
  std::vector<std::string> goals, free, priors, inputs;
  std::vector<double> tensions, lengths;
  ident::PlanOptions plan;
};

// "NAME=PERCENT%" or "NAME=STD".
ident::PlanGoal goal_of(const std::string& text) {
  const auto given =
      named_numbers("--goal", text, "NAME=PERCENT%, such as cable.EI=5%, or NAME=STD", 1, 1, true);
  return {given.name, given.numbers[0], given.relative};
}

std::string relative_text(double std, double value) {
  return std::isfinite(std) && value != 0 ? std_digits(100 * std / std::abs(value)) + " %" : "-";
}

void print_plan(const ident::PlanResult& plan, VerbContext& context) {
  auto& out = context.out;
  describe::Table table{"", {"step", "predicted std after it", "cost, s"}, {true, false, true}, {}};
  for (const auto& parameter : plan.parameters) {
    table.heads.push_back(parameter.name);
    table.numeric.push_back(true);
  }
  const auto add = [&](const std::string& what, double cost, auto std_of) {
    auto& row = table.rows.emplace_back(
        std::vector{std::to_string(table.rows.size()), what, fmt::format("{:.0f}", cost)});
    for (std::size_t p = 0; p < plan.parameters.size(); ++p) {
      row.push_back(relative_text(std_of(p), plan.parameters[p].value));
    }
  };
  add("known before", 0, [&](auto p) { return plan.parameters[p].std_before; });
  for (const auto& proposal : plan.proposals) {
    add(proposal.what, proposal.cost_s, [&](auto p) { return proposal.parameters[p].std; });
  }
  describe::print(out, table);
  for (const auto& goal : plan.goals) {
    const auto& one = plan.parameters[goal.parameter];
    out << fmt::format("{}: std {} ({}), goal {}: {}; with everything measured {}\n", one.name,
                       std_digits(one.std), relative_text(one.std, one.value),
                       std_digits(goal.wanted_std), goal.reached ? "reached" : "out of reach",
                       std_digits(one.best_std));
  }
}

void tell_plan(const ident::PlanResult& plan, VerbContext& context) {
  for (const auto& goal : plan.goals) {
    const auto& one = plan.parameters[goal.parameter];
    if (goal.reached) continue;
    context.refuse(
        "goal_out_of_reach",
        fmt::format("To know {} to {}, {}", one.name, std_digits(goal.wanted_std), goal.takes),
        one.name);
  }
  for (const auto& open : plan.not_identifiable) {
    context.warn("not_identifiable", "Whatever is measured, " + open.message);
  }
  for (const auto& text : plan.left_out) context.warn("state_left_out", text);
}

Json run(PlanCommand& command, VerbContext& context) {
  const model::Scene scene = scene_of(command.scene, context);
  std::vector<ident::PlanGoal> goals;
  auto names = command.free;
  for (const auto& text : command.goals) {
    goals.push_back(goal_of(text));
    const auto& goal = goals.back().parameter;
    const bool named = std::ranges::any_of(
        names, [&](const auto& name) { return free_parameter(name).name == goal; });
    if (!named) names.push_back(goal);
  }
  auto options = command.plan;
  std::ranges::sort(options.hits);
  std::ranges::sort(options.durations_s);
  options.threads = context.threads;
  UpdateStates states;
  states.states = ident::plan_states(scene, command.tensions, command.lengths);
  states.tension.resize(states.states.size());
  options.inputs = uncertain_inputs(command.inputs, states);
  const auto plan = ident::plan_measurements(
      states.states, free_parameters(names, command.priors, scene), goals, options);
  if (!plan.failure.empty()) throw NotConverged(command.scene + ": " + plan.failure);
  print_plan(plan, context);
  tell_plan(plan, context);
  return describe::json_of(plan);
}

describe::Options options_of(PlanCommand& c) {
  return {
      option("scene", c.scene, "Scene file (TOML), near the truth").required(),
      option("--goal", c.goals,
             "Standard uncertainty to be reached, NAME=PERCENT% or NAME=STD: the parameter is free")
          .required()
          .type("NAME=PERCENT%"),
      option("--free", c.free, "Further parameters that are unknown, as in `rigfit update`"),
      option("--prior", c.priors, "NAME=VALUE,STD of a free parameter, from other tests"),
      option("--input", c.inputs, "Uncertainty of what is not fitted, as in `rigfit update`"),
      option("--tension", c.tensions, "Further tensions of all cables that can be set", "N")
          .positive(),
      option("--length", c.lengths, "Further lengths of the only member that can be set", "m")
          .positive(),
      option("--hits", c.plan.hits, "Numbers of hits that a test may average (default: 5 10 20)")
          .within(1, 1000),
      option("--duration", c.plan.durations_s, "Durations that records may have (default: 4 8 16)",
             "s")
          .within(1e-3, 3600),
      option("--noise", c.plan.noise_std,
             "Noise of one sample, in the sensors' unit (default: typical instruments)")
          .positive(),
      option(
          "--frequency-std", c.plan.frequency_relative_std,
          "Relative standard uncertainty of the frequency of every mode seen in a state, instead "
          "of what noise, hits and duration give")
          .within(1e-9, 1.0),
      option("--model-std", c.plan.model_relative_std,
             "Relative error in frequency of the model itself (default: the scene's accuracy)")
          .within(0.0, 1.0)};
}

}  // namespace

Verb plan_verb() {
  return verb_of<PlanCommand>(
      "plan", "What to measure so that parameters are known to a goal",
      "Every step adds a hammer test, a sensor, hits or longer records, the one that helps most "
      "per "
      "time first; `rigfit update` with the proposed modes gives the predicted std. Exit code 4 "
      "when a goal is out of reach.\nExample:\n"
      "  rigfit plan testdata/jalali2021/scenes/cable.toml --goal cable.EI=5% \\\n"
      "    --free cable.tension --input right.x=0.002",
      run, false, false, describe::schema_of<ident::PlanResult>);
}

}  // namespace rigfit::apps
