#include "ident/campaign/single_tests/scene_use.h"

#include <cmath>
#include <utility>

#include "model/scene/parameters.h"

namespace rigfit::ident {

SceneOfState scene_at(const SceneUse& use, const KnownValues& known,
                      std::optional<double> tension_N) {
  SceneOfState state{use.scene, {}};
  const auto set = [&](const std::vector<std::string>& names, double value) {
    for (const auto& name : names) {
      if (std::isfinite(value)) model::set_parameter(state.scene, name, value);
    }
  };
  if (known.axial) {
    set(use.EA_of, known.axial->EA_N.value);
    set(use.damping_of, known.axial->damping_ratio.value);
  }
  if (!tension_N) return state;
  set(use.tension_of, *tension_N);
  if (known.EI.empty() || use.EI_of.empty()) return state;
  state.EI_Nm2 = known.EI.at(*tension_N).EI_Nm2;
  set(use.EI_of, *state.EI_Nm2);
  return state;
}

std::vector<UncertainInput> known_inputs(const KnownValues& known,
                                         const std::vector<StateUse>& states) {
  std::vector<UncertainInput> inputs;
  /// `std_in`: standard uncertainty of the value in a state.
  const auto add = [&](std::string name, std::vector<std::string> SceneUse::*names, auto std_in) {
    UncertainInput input{std::move(name), {}};
    for (const auto& one : states) {
      const double change = std_in(one);
      if (!std::isfinite(change) || change == 0) continue;
      for (const auto& target : one.use->*names) {
        input.effects.push_back({one.state, target, change});
      }
    }
    if (!input.effects.empty()) inputs.push_back(std::move(input));
  };
  std::vector<double> tensions;
  for (const auto& one : states) tensions.push_back(one.tension_N.value_or(1));
  for (const auto& term : known.EI.uncertainty(tensions)) {
    add(term.name, &SceneUse::EI_of, [&](const StateUse& one) {
      return one.tension_N ? term.change_Nm2[&one - states.data()] : 0;
    });
  }
  if (!known.axial) return inputs;
  add("EA (axial test)", &SceneUse::EA_of, [&](const auto&) { return known.axial->EA_N.std; });
  add("damping ratio (axial test)", &SceneUse::damping_of,
      [&](const auto&) { return known.axial->damping_ratio.std; });
  return inputs;
}

}  // namespace rigfit::ident
