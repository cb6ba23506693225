#include "ident/campaign/single_tests/scene_use.h"

#include <cmath>
#include <utility>

#include "model/scene/parameters.h"

namespace rigfit::ident {

model::Scene scene_at(const SceneUse& use, const KnownValues& known,
                      std::optional<double> tension_N) {
  model::Scene scene = use.scene;
  const auto set = [&](const std::vector<std::string>& names, double value) {
    for (const auto& name : names) {
      if (std::isfinite(value)) model::set_parameter(scene, name, value);
    }
  };
  set(use.EA_of, known.EA_N.value);
  set(use.damping_of, known.damping_ratio.value);
  if (!tension_N) return scene;
  set(use.tension_of, *tension_N);
  if (!known.EI.empty()) set(use.EI_of, known.EI.at(*tension_N).EI_Nm2);
  return scene;
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
      for (const auto& target : one.use.*names) {
        input.effects.push_back({one.state, target, change});
      }
    }
    if (!input.effects.empty()) inputs.push_back(std::move(input));
  };
  std::vector<double> tensions;
  tensions.reserve(states.size());
  for (const auto& one : states) tensions.push_back(one.tension_N.value_or(1));
  for (const auto& term : known.EI.uncertainty(tensions)) {
    add(term.name, &SceneUse::EI_of, [&](const StateUse& one) {
      return one.tension_N ? term.change_Nm2[&one - states.data()] : 0;
    });
  }
  add("EA (axial test)", &SceneUse::EA_of, [&](const auto&) { return known.EA_N.std; });
  add("damping ratio (axial test)", &SceneUse::damping_of,
      [&](const auto&) { return known.damping_ratio.std; });
  return inputs;
}

}  // namespace rigfit::ident
