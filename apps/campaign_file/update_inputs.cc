#include "apps/campaign_file/update_inputs.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/cli/exit_code.h"
#include "ident/campaign/single_tests/axial_campaign.h"
#include "ident/campaign/single_tests/scene_use.h"
#include "model/scene/scene_error.h"

namespace rigfit::apps {
namespace {

using Effect = ident::UncertainInput::Effect;

struct InputText {
  std::string name;
  std::vector<std::string> targets;
  std::vector<double> signs;
  double std = 0;
  bool relative = false, each = false;
};

InputText parsed(const std::string& whole) {
  const auto fail = [&](const char* problem) {
    throw UsageError(fmt::format(
        "--input \"{}\": {}; write TARGET=STD, TARGET=0.5%, TARGET,-TARGET=STD, @each at the end",
        whole, problem));
  };
  InputText input;
  std::string text = whole;
  if (text.ends_with("@each")) {
    input.each = true;
    text.resize(text.size() - 5);
  }
  const auto equals = text.rfind('=');
  if (equals == std::string::npos) fail("has no \"=\"");
  input.name = text.substr(0, equals);
  std::string number = text.substr(equals + 1);
  if (number.ends_with("%")) {
    input.relative = true;
    number.pop_back();
  }
  const auto [end, error] =
      std::from_chars(number.data(), number.data() + number.size(), input.std);
  if (error != std::errc() || end != number.data() + number.size() || !std::isfinite(input.std) ||
      !(input.std > 0)) {
    fail("its uncertainty is no positive number");
  }
  if (input.relative) input.std /= 100;
  for (std::size_t begin = 0;;) {
    const auto comma = input.name.find(',', begin);
    std::string target = input.name.substr(begin, comma - begin);
    const bool minus = target.starts_with("-");
    if (minus) target.erase(0, 1);
    if (target.empty()) fail("an empty name");
    input.targets.push_back(target);
    input.signs.push_back(minus ? -1 : 1);
    if (comma == std::string::npos) break;
    begin = comma + 1;
  }
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
  if (input.targets[0] == "tension") {
    add_tension(states, state, input.std, input.relative, effects);
    return;
  }
  for (std::size_t t = 0; t < input.targets.size(); ++t) {
    if (!has_parameter(scene, input.targets[t])) continue;
    const double size = input.relative ? std::abs(model::parameter(scene, input.targets[t])) : 1;
    effects.push_back(
        {static_cast<int>(state), input.targets[t], input.signs[t] * input.std * size});
  }
}

// Between its nodes, m; 0: no such member.
double member_length(const model::Scene& scene, const std::string& name) {
  for (const auto& member : scene.members) {
    if (member.name != name) continue;
    std::vector<Eigen::Vector3d> ends;
    for (const auto& node : scene.nodes) {
      if (node.name == member.nodes[0] || node.name == member.nodes[1]) {
        ends.push_back(node.position);
      }
    }
    return ends.size() == 2 ? (ends[1] - ends[0]).norm() : 0;
  }
  return 0;
}

}  // namespace

std::vector<ident::UncertainInput> uncertain_inputs(const std::vector<std::string>& texts,
                                                    double stiffness_common_std,
                                                    const UpdateStates& states) {
  std::vector<ident::UncertainInput> inputs;
  for (const auto& text : texts) {
    const InputText input = parsed(text);
    for (const auto& target : input.targets) {
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
  std::vector<ident::StiffnessUse> uses;
  ident::UncertainInput common{"EI, common to all tests", {}};
  for_each_cable(states, [&](std::size_t s, const model::Member& member) {
    if (!states.tension[s]) return;
    const std::string name = member.name + ".EI";
    uses.push_back({static_cast<int>(s), name, *states.tension[s]});
    const double change = stiffness_common_std * member.EI[0];
    if (change > 0) common.effects.push_back({static_cast<int>(s), name, change});
  });
  for (auto& input : ident::stiffness_inputs(states.stiffness, uses)) {
    inputs.push_back(std::move(input));
  }
  if (!common.effects.empty()) inputs.push_back(std::move(common));
  return inputs;
}

std::vector<ident::UncertainInput> aim_inputs(const std::vector<std::string>& texts,
                                              const UpdateStates& states) {
  std::vector<ident::UncertainInput> inputs;
  for (const auto& text : texts) {
    const auto fail = [&](const std::string& problem) {
      throw UsageError(fmt::format(
          "--aim \"{}\": {}; write LOAD=METRES,DEGREES, such as hammer=0.003,2", text, problem));
    };
    const auto equals = text.rfind('='), comma = text.find(',', equals + 1);
    if (equals == std::string::npos || comma == std::string::npos) fail("is not understood");
    const std::string name = text.substr(0, equals);
    const auto number = [&](std::size_t begin, std::size_t end, double most) {
      double value = 0;
      const auto [stop, error] = std::from_chars(text.data() + begin, text.data() + end, value);
      if (error != std::errc() || stop != text.data() + end || !(value >= 0 && value <= most)) {
        fail(fmt::format("\"{}\" is no number from 0 to {:g}", text.substr(begin, end - begin),
                         most));
      }
      return value;
    };
    const double metres = number(equals + 1, comma, 1e3);
    const double turn = number(comma + 1, text.size(), 45) * M_PI / 180;
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
        if (!(turn > 0)) continue;
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
    if (!found) fail("the scene has no such load; there are:" + (known.empty() ? " none" : known));
  }
  return inputs;
}

std::vector<ident::UncertainInput> axial_inputs(const std::string& path, bool with_damping,
                                                UpdateStates& states) {
  std::ifstream file(path, std::ios::binary);
  const auto document = nlohmann::json::parse(file, nullptr, false);
  const auto read = [&](const char* quantity) {
    const auto number = [&](const char* key) {
      if (!document.is_object() || !document.contains(quantity)) return std::nan("");
      const auto& value = document[quantity];
      return value.is_object() && value.contains(key) && value[key].is_number()
                 ? value[key].get<double>()
                 : std::nan("");
    };
    const signal::Estimate estimate{number("value"), number("std")};
    if (!(estimate.value > 0) || !(estimate.std > 0)) {
      throw model::SceneError({path, 0, 0, quantity}, "is no result of the axial test with its std",
                              "give what rigfit axial ... --json FILE wrote");
    }
    return estimate;
  };
  ident::AxialKnowledge known{read("EA_N"), {}};
  if (with_damping) known.damping_ratio = read("damping_ratio");
  ident::AxialUncertainty uncertainty;
  for (std::size_t s = 0; s < states.states.size(); ++s) {
    auto& scene = states.states[s].scene;
    std::vector<std::string> EA_of, damping_of;
    for (auto& member : scene.members) {
      if (member.kind != model::Member::Kind::cable) continue;
      EA_of.push_back(member.name + ".EA");
      if (!with_damping) continue;
      member.damping = {};  // the ratio takes the place of joint dampers
      member.damping_ratio = known.damping_ratio.value;
      damping_of.push_back(member.name + ".damping_ratio");
    }
    ident::apply_axial(known, EA_of, damping_of, scene, static_cast<int>(s), &uncertainty);
  }
  std::vector<ident::UncertainInput> inputs{std::move(uncertainty.EA)};
  if (with_damping) inputs.push_back(std::move(uncertainty.damping));
  return inputs;
}

}  // namespace rigfit::apps
