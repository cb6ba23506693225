#include "apps/cli/json_document.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "apps/describe/json_of.h"
#include "model/scene/scene_error.h"

namespace rigfit::apps {

Json json_document(const VerbContext& context, const std::string& verb, const Json& result) {
  context.check_inputs();
  Json document{{"rigfit", RIGFIT_VERSION}, {"command", verb}, {"inputs", Json::array()}};
  for (const auto& input : context.inputs()) {
    document["inputs"].push_back({{"path", input.path}, {"sha256", input.sha256}});
  }
  document["warnings"] = describe::json_of(context.warnings());
  document["notes"] = describe::json_of(context.notes());
  if (context.exit_code != ExitCode::done) {
    document["error"] = {{"exit_code", static_cast<int>(context.exit_code)}};
    document["error"].update(describe::json_of(context.ended_by()));
  }
  document.update(result);
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
