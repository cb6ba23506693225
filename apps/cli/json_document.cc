#include "apps/cli/json_document.h"

#include <cmath>
#include <fstream>
#include <string>

#include "model/scene/scene_error.h"

namespace rigfit::apps {
namespace {

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
  const auto list = [](const std::vector<Finding>& findings) {
    Json all = Json::array();
    for (const auto& one : findings) {
      all.push_back({{"code", one.code}, {"message", one.message}, {"where", one.where}});
    }
    return all;
  };
  document["warnings"] = list(context.warnings());
  document["notes"] = list(context.notes());
  if (context.exit_code != ExitCode::done) document["error"] = error_json(context);
  for (auto& [key, value] : result.items()) document[key] = std::move(value);
  return document;
}

Json read_document(const std::filesystem::path& path, const char* key, const char* by) {
  std::ifstream file(path, std::ios::binary);
  Json json = Json::parse(file, nullptr, false);
  if (json.is_object() && json.contains(key)) return json;
  throw model::SceneError({path.string(), 0, 0, key}, "is no such result",
                          std::string("give what ") + by + " wrote");
}

double number_in(const Json& object, const char* key) {
  const bool there = object.is_object() && object.contains(key) && object[key].is_number();
  return there ? object[key].get<double>() : std::nan("");
}

}  // namespace rigfit::apps
