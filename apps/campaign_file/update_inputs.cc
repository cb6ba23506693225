#include "apps/campaign_file/update_inputs.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/cli/exit_code.h"
#include "apps/cli/json_document.h"
#include "apps/cli/named_numbers.h"
#include "apps/results/modal_files.h"
#include "ident/campaign/single_tests/axial_campaign.h"
#include "ident/campaign/single_tests/scene_use.h"
#include "model/scene/scene.h"
#include "model/scene/scene_error.h"

namespace rigfit::apps {
namespace {

using Effect = ident::UncertainInput::Effect;

struct InputText {
  std::string name;
  SignedNames targets;
  double std = 0;
  bool relative = false, each = false;
};

InputText parsed(std::string text) {
  InputText input;
  input.each = text.ends_with("@each");
  if (input.each) text.resize(text.size() - 5);
  const auto given =
      named_numbers("--input", text,
                    "TARGET=STD, TARGET=0.5% or TARGET,-TARGET=STD (@each at the end)", 1, 1, true);
  input.name = given.name;
  input.targets = signed_names("--input", given.name);
  input.std = given.numbers[0], input.relative = given.relative;
  return input;
}

bool has_parameter(const model::Scene& scene, const std::string& name) {
  const auto names = model::parameter_names(scene);
  return std::find(names.begin(), names.end(), name) != names.end();
}

template <typename Function>
void for_each_cable(const UpdateStates& states, Function function) {
  for (std::size_t s = 0; s < states.states.size(); ++s) {
    for (const auto& member : states.states[s].scene.members) {
      if (member.kind == model::Member::Kind::cable) function(s, member);
    }
  }
}

// The effects of a state's tension being off by `std`.
void add_tension(const UpdateStates& states, std::size_t state, double std, bool relative,
                 std::vector<Effect>& effects) {
  for_each_cable(states, [&](std::size_t s, const model::Member& member) {
    if (s != state || !member.tension) return;
    const double change = relative ? std * *member.tension : std;
    effects.push_back({static_cast<int>(s), member.name + ".tension", change});
    if (states.stiffness.empty() || !states.tension[s]) return;
    const double slope = states.stiffness.at(*states.tension[s]).slope_m2;
    effects.push_back({static_cast<int>(s), member.name + ".EI", slope * change});
  });
}

void add_targets(const InputText& input, const UpdateStates& states, std::size_t state,
                 std::vector<Effect>& effects) {
  const auto& scene = states.states[state].scene;
  if (input.targets.names[0] == "tension") {
    add_tension(states, state, input.std, input.relative, effects);
    return;
  }
  for (std::size_t t = 0; t < input.targets.names.size(); ++t) {
    if (!has_parameter(scene, input.targets.names[t])) continue;
    const double size =
        input.relative ? std::abs(model::parameter(scene, input.targets.names[t])) : 1;
    effects.push_back({static_cast<int>(state), input.targets.names[t],
                       input.targets.signs[t] * input.std * size});
  }
}

// Between its nodes, m; 0: no such member.
double member_length(const model::Scene& scene, const std::string& name) {
  const auto end = [&](double position) { return position_of(scene, {"", name, position}); };
  return (end(1) - end(0)).norm();
}

}  // namespace

std::vector<ident::UncertainInput> uncertain_inputs(const std::vector<std::string>& texts,
                                                    double stiffness_common_std,
                                                    const UpdateStates& states) {
  std::vector<ident::UncertainInput> inputs;
  for (const auto& text : texts) {
    const InputText input = parsed(text);
    for (const auto& target : input.targets.names) {
      if (target == "tension") continue;
      bool somewhere = false;
      for (const auto& state : states.states) {
        somewhere = somewhere || has_parameter(state.scene, target);
      }
      // Says which parameters there are.
      if (!somewhere) (void)model::parameter(states.states.front().scene, target);
    }
    ident::UncertainInput all{input.name, {}};
    for (std::size_t s = 0; s < states.states.size(); ++s) {
      if (!input.each) {
        add_targets(input, states, s, all.effects);
        continue;
      }
      ident::UncertainInput one{fmt::format("{} [{}]", input.name, states.states[s].name), {}};
      add_targets(input, states, s, one.effects);
      if (!one.effects.empty()) inputs.push_back(std::move(one));
    }
    if (!all.effects.empty()) inputs.push_back(std::move(all));
  }
  if (states.stiffness.empty()) return inputs;
  std::vector<ident::SceneUse> uses(states.states.size());
  ident::UncertainInput common{"EI, common to all tests", {}};
  for_each_cable(states, [&](std::size_t s, const model::Member& member) {
    if (!states.tension[s]) return;
    const std::string name = member.name + ".EI";
    uses[s].EI_of.push_back(name);
    const double change = stiffness_common_std * member.EI[0];
    if (change > 0) common.effects.push_back({static_cast<int>(s), name, change});
  });
  std::vector<ident::StateUse> of_states;
  for (std::size_t s = 0; s < uses.size(); ++s) {
    of_states.push_back({static_cast<int>(s), &uses[s], states.tension[s]});
  }
  for (auto& input : ident::known_inputs({states.stiffness, {}}, of_states)) {
    inputs.push_back(std::move(input));
  }
  if (!common.effects.empty()) inputs.push_back(std::move(common));
  return inputs;
}

std::vector<ident::UncertainInput> aim_inputs(const std::vector<std::string>& texts,
                                              const UpdateStates& states) {
  std::vector<ident::UncertainInput> inputs;
  for (const auto& text : texts) {
    const auto aim =
        named_numbers("--aim", text, "LOAD=METRES,DEGREES, such as hammer=0.003,2", 2, 2);
    const auto& name = aim.name;
    const double metres = aim.numbers[0], turn = aim.numbers[1] * M_PI / 180;
    if (!(metres >= 0 && metres <= 1e3 && aim.numbers[1] <= 45)) {
      throw UsageError("--aim: \"" + text + "\" is beyond 1000 m or 45 degrees");
    }
    bool found = false;
    std::string known;
    for (std::size_t s = 0; s < states.states.size(); ++s) {
      const auto& scene = states.states[s].scene;
      const std::string state =
          states.states[s].name.empty() ? "" : fmt::format(" [{}]", states.states[s].name);
      for (const auto& load : scene.loads) {
        known += known.find(load.name) == std::string::npos ? " " + load.name : "";
        if (load.name != name) continue;
        found = true;
        const int index = static_cast<int>(s);
        const double length = member_length(scene, load.place.member);
        if (metres > 0 && load.place.node.empty() && length > 0) {
          inputs.push_back({fmt::format("place of {}{}", name, state),
                            {{index, name + ".position", metres / length}}});
        }
        const Eigen::Vector3d first = load.direction.unitOrthogonal();
        for (const Eigen::Vector3d& side : {first, Eigen::Vector3d(load.direction.cross(first))}) {
          // Named after the axis it leans to.
          Eigen::Index axis = 0;
          side.cwiseAbs().maxCoeff(&axis);
          ident::UncertainInput input{
              fmt::format("direction of {} to {}{}", name, "xyz"[axis], state), {}};
          for (int k = 0; k < 3; ++k) {
            if (std::abs(side[k]) < 1e-12) continue;
            input.effects.push_back(
                {index, fmt::format("{}.direction_{}", name, "xyz"[k]), turn * side[k]});
          }
          inputs.push_back(std::move(input));
        }
      }
    }
    if (!found) {
      throw UsageError("--aim: the scene has no load " + name +
                       "; there are:" + (known.empty() ? " none" : known));
    }
  }
  return inputs;
}

std::vector<ident::UncertainInput> axial_inputs(const std::string& path, bool with_damping,
                                                UpdateStates& states) {
  constexpr const char* kBy = "rigfit axial ... --json FILE";
  const Json document = read_document(path, "EA_N", kBy);
  const auto read = [&](const char* quantity) {
    const Json value = document.value(quantity, Json());
    const signal::Estimate estimate{number_in(value, "value"), number_in(value, "std")};
    if (!(estimate.value > 0) || !(estimate.std > 0)) {
      throw model::SceneError({path, 0, 0, quantity}, "has no std: it cannot be weighed",
                              "give --length-std and --mass-std to rigfit axial");
    }
    return estimate;
  };
  ident::KnownValues known{{}, ident::AxialKnowledge{read("EA_N"), {}}};
  if (with_damping) known.axial->damping_ratio = read("damping_ratio");
  std::vector<ident::SceneUse> uses(states.states.size());
  std::vector<ident::StateUse> of_states;
  for (std::size_t s = 0; s < uses.size(); ++s) {
    auto& scene = states.states[s].scene;
    for (auto& member : scene.members) {
      if (member.kind != model::Member::Kind::cable) continue;
      uses[s].EA_of.push_back(member.name + ".EA");
      if (!with_damping) continue;
      member.damping = {};  // the ratio takes the place of joint dampers
      member.damping_ratio = known.axial->damping_ratio.value;
      uses[s].damping_of.push_back(member.name + ".damping_ratio");
    }
    uses[s].scene = scene;
    scene = ident::scene_at(uses[s], known, {}).scene;
    of_states.push_back({static_cast<int>(s), &uses[s], {}});
  }
  return ident::known_inputs(known, of_states);
}

ident::FreeParameter free_parameter(std::string text) {
  ident::FreeParameter parameter;
  if (text.ends_with("@each")) {
    parameter.per_state = true;
    text.resize(text.size() - 5);
  }
  const auto equals = text.find('=');
  parameter.name = text.substr(0, equals);
  if (equals != std::string::npos) {
    auto targets = signed_names("--free", text.substr(equals + 1));
    parameter.targets = std::move(targets.names);
    parameter.factors = std::move(targets.signs);
  }
  if (parameter.name.empty()) throw UsageError("--free: a parameter without a name");
  return parameter;
}

std::vector<ident::FreeParameter> free_parameters(const std::vector<std::string>& free_texts,
                                                  const std::vector<std::string>& priors,
                                                  const model::Scene& scene) {
  std::vector<ident::FreeParameter> free;
  free.reserve(free_texts.size());
  for (const auto& text : free_texts) free.push_back(free_parameter(text));
  if (free.empty()) {
    for (const auto& member : scene.members) {
      const std::string name = member.name + (member.EI[0] == member.EI[1] ? ".EI" : ".EI_z");
      free.push_back(free_parameter(name));
    }
  }
  for (const auto& text : priors) {
    const auto prior = named_numbers("--prior", text, "NAME=VALUE,STD", 2, 2);
    auto known = std::find_if(free.begin(), free.end(),
                              [&](const auto& parameter) { return parameter.name == prior.name; });
    if (known == free.end()) throw UsageError("--prior: " + prior.name + " is not among --free");
    known->prior = signal::Estimate{prior.numbers[0], prior.numbers[1]};
  }
  return free;
}

}  // namespace rigfit::apps
