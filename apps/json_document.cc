#include "apps/json_document.h"

#include <cmath>
#include <iostream>

#include "apps/sha256.h"

namespace rigfit::apps {
namespace {

void replace_non_finite(Json& value) {
  if (value.is_number_float() && !std::isfinite(value.get<double>())) {
    value = nullptr;
  } else if (value.is_structured()) {
    for (auto& child : value) replace_non_finite(child);
  }
}

}  // namespace

void VerbContext::warn(std::string code, std::string message, std::string where) {
  if (!quiet) {
    std::cerr << "warning: " << (where.empty() ? "" : where + ": ") << message << '\n';
  }
  warnings_.push_back({std::move(code), std::move(message), std::move(where)});
}

void VerbContext::refuse(std::string code, std::string message, std::string where) {
  std::cerr << "refused: " << (where.empty() ? "" : where + ": ") << message << '\n';
  warnings_.push_back({std::move(code), std::move(message), std::move(where)});
  exit_code = ExitCode::refused;
}

void VerbContext::input(const std::string& path) {
  for (const auto& known : inputs_) {
    if (known == path) return;
  }
  inputs_.push_back(path);
}

Json json_document(const VerbContext& context, const std::string& verb, Json result) {
  Json document;
  document["rigfit"] = RIGFIT_VERSION;
  document["command"] = verb;
  Json inputs = Json::array();
  for (const auto& path : context.inputs()) {
    inputs.push_back({{"path", path}, {"sha256", sha256_of_file(path)}});
  }
  document["inputs"] = std::move(inputs);
  Json warnings = Json::array();
  for (const auto& warning : context.warnings()) {
    warnings.push_back(
        {{"code", warning.code}, {"message", warning.message}, {"where", warning.where}});
  }
  document["warnings"] = std::move(warnings);
  replace_non_finite(result);
  for (auto& [key, value] : result.items()) document[key] = std::move(value);
  return document;
}

Json json_estimate(double value, double std) {
  return {{"value", std::isfinite(value) ? Json(value) : Json(nullptr)},
          {"std", std::isfinite(std) ? Json(std) : Json(nullptr)}};
}

}  // namespace rigfit::apps
