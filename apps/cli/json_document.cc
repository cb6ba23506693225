#include "apps/cli/json_document.h"

#include <cmath>

namespace rigfit::apps {
namespace {

void replace_non_finite(Json& value) {
  if (value.is_number_float() && !std::isfinite(value.get<double>())) {
    value = nullptr;
  } else if (value.is_structured()) {
    for (auto& child : value) replace_non_finite(child);
  }
}

/// Why the run ends with another exit code than 0: the finding that ended it.
Json error_json(const VerbContext& context) {
  const bool refused = context.exit_code == ExitCode::refused;
  Json error{{"exit_code", static_cast<int>(context.exit_code)},
             {"code", refused ? "refused" : "not_converged"},
             {"message", ""},
             {"where", ""}};
  for (const auto& warning : context.warnings()) {
    if (refused ? !warning.refused : warning.code != "not_converged") continue;
    error["code"] = warning.code;
    error["message"] = warning.message;
    error["where"] = warning.where;
    break;
  }
  return error;
}

}  // namespace

Json json_document(const VerbContext& context, const std::string& verb, Json result) {
  Json document;
  document["rigfit"] = RIGFIT_VERSION;
  document["command"] = verb;
  Json inputs = Json::array();
  context.check_inputs();
  for (const auto& input : context.inputs()) {
    inputs.push_back({{"path", input.path}, {"sha256", input.sha256}});
  }
  document["inputs"] = std::move(inputs);
  const auto list = [](const std::vector<Warning>& findings) {
    Json all = Json::array();
    for (const auto& one : findings) {
      all.push_back({{"code", one.code}, {"message", one.message}, {"where", one.where}});
    }
    return all;
  };
  document["warnings"] = list(context.warnings());
  document["notes"] = list(context.notes());
  if (context.exit_code != ExitCode::done) document["error"] = error_json(context);
  replace_non_finite(result);
  for (auto& [key, value] : result.items()) document[key] = std::move(value);
  return document;
}

Json json_number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json json_estimate(double value, double std) {
  return {{"value", json_number(value)}, {"std", json_number(std)}};
}

}  // namespace rigfit::apps
