#include "apps/results/update_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "apps/cli/exit_code.h"
#include "model/scene/scene.h"

namespace rigfit::apps {
namespace {

double number_of(const std::string& text, const std::string& option) {
  try {
    std::size_t used = 0;
    const double value = std::stod(text, &used);
    if (used == text.size() && std::isfinite(value)) return value;
  } catch (const std::exception&) {
  }
  throw UsageError(fmt::format("{}: \"{}\" is no number", option, text));
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0;;) {
    const auto end = text.find(at, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string::npos) return parts;
    begin = end + 1;
  }
}

}  // namespace

ident::FreeParameter free_parameter(std::string text) {
  ident::FreeParameter parameter;
  if (text.ends_with("@each")) {
    parameter.per_state = true;
    text.resize(text.size() - 5);
  }
  const auto equals = text.find('=');
  parameter.name = text.substr(0, equals);
  if (equals != std::string::npos) {
    for (std::string target : split(text.substr(equals + 1), ',')) {
      const bool minus = target.starts_with("-");
      if (minus) target.erase(0, 1);
      if (target.empty()) throw UsageError("--free: an empty name in \"" + text + "\"");
      parameter.targets.push_back(target);
      parameter.factors.push_back(minus ? -1 : 1);
    }
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
    const auto equals = text.find('=');
    const auto values = equals == std::string::npos ? std::vector<std::string>{}
                                                    : split(text.substr(equals + 1), ',');
    if (values.size() != 2) {
      throw UsageError("--prior: write NAME=VALUE,STD, not \"" + text + "\"");
    }
    const std::string name = text.substr(0, equals);
    auto known = std::find_if(free.begin(), free.end(),
                              [&](const auto& parameter) { return parameter.name == name; });
    if (known == free.end()) throw UsageError("--prior: " + name + " is not among --free");
    known->prior =
        signal::Estimate{number_of(values[0], "--prior"), number_of(values[1], "--prior")};
    if (!(known->prior->std > 0)) throw UsageError("--prior: the uncertainty must be positive");
  }
  return free;
}

}  // namespace rigfit::apps
