#include "apps/results/update_parameters.h"

#include <algorithm>
#include <utility>

#include "apps/cli/exit_code.h"
#include "apps/cli/named_numbers.h"
#include "model/scene/scene.h"

namespace rigfit::apps {

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
