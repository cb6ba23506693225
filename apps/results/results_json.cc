#include "apps/results/results_json.h"

#include <fstream>

#include "apps/describe/json_of.h"
#include "model/scene/scene.h"

namespace rigfit::apps {

Json axial_json(const ident::AxialCampaignResult& result) {
  Json out = result.test ? describe::json_of(*result.test) : Json::object();
  out["samples"] = describe::json_of(result.decays);
  return out;
}

Json hits_json(const std::vector<signal::StruckPoint>& places, const ident::HammerTest& test) {
  Json hits = Json::array();
  for (std::size_t p = 0; p < test.tests.size(); ++p) {
    for (const signal::Hit& hit : test.tests[p].search.hits) {
      hits.push_back({{"file", places[p].recordings[hit.recording].path.string()}});
      hits.back().update(describe::json_of(hit));
      if (!places[p].name.empty()) hits.back()["struck"] = places[p].name;
    }
  }
  return hits;
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
