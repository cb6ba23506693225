#include "ident/campaign/single_tests/scene_use.h"

#include "model/scene/parameters.h"

namespace rigfit::ident {

SceneOfState scene_at(const SceneUse& use, const KnownValues& known,
                      std::optional<double> tension_N) {
  SceneOfState state{use.scene, {}};
  if (known.axial) apply_axial(*known.axial, use.EA_of, use.damping_of, state.scene);
  if (!tension_N) return state;
  for (const auto& name : use.tension_of) model::set_parameter(state.scene, name, *tension_N);
  if (known.EI.empty() || use.EI_of.empty()) return state;
  state.EI_Nm2 = known.EI.at(*tension_N).EI_Nm2;
  for (const auto& name : use.EI_of) model::set_parameter(state.scene, name, *state.EI_Nm2);
  return state;
}

std::vector<UncertainInput> stiffness_inputs(const StiffnessCurve& curve,
                                             const std::vector<StiffnessUse>& uses) {
  std::vector<double> tensions;
  tensions.reserve(uses.size());
  for (const auto& use : uses) tensions.push_back(use.tension_N);
  std::vector<UncertainInput> inputs;
  for (const auto& term : curve.uncertainty(tensions)) {
    UncertainInput input{term.name, {}};
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const double change = term.change_Nm2[static_cast<Eigen::Index>(i)];
      if (change != 0) input.effects.push_back({uses[i].state, uses[i].parameter, change});
    }
    inputs.push_back(std::move(input));
  }
  return inputs;
}

std::vector<UncertainInput> known_inputs(const KnownValues& known,
                                         const std::vector<StateUse>& states) {
  std::vector<StiffnessUse> stiffness;
  AxialUncertainty axial;
  for (const auto& one : states) {
    if (known.axial) {
      model::Scene scene = one.use->scene;
      apply_axial(*known.axial, one.use->EA_of, one.use->damping_of, scene, one.state, &axial);
    }
    if (known.EI.empty() || !one.tension_N) continue;
    for (const auto& name : one.use->EI_of) stiffness.push_back({one.state, name, *one.tension_N});
  }
  std::vector<UncertainInput> inputs;
  if (!stiffness.empty()) inputs = stiffness_inputs(known.EI, stiffness);
  for (auto* input : {&axial.EA, &axial.damping}) {
    if (!input->effects.empty()) inputs.push_back(std::move(*input));
  }
  return inputs;
}

}  // namespace rigfit::ident
