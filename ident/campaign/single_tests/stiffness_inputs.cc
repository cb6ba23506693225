#include "ident/campaign/single_tests/stiffness_inputs.h"

namespace rigfit::ident {

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

}  // namespace rigfit::ident
