#include "apps/cli/result_schema.h"

#include "apps/describe/json_of.h"
#include "ident/campaign/single_tests/axial_campaign.h"
#include "ident/campaign/single_tests/tension_campaign.h"

namespace rigfit::apps {

nlohmann::ordered_json result_schema() {
  auto axial = describe::schema_of<ident::AxialTestResult>();
  axial["properties"]["samples"] = describe::schema_of<std::vector<ident::AxialRecord>>();
  auto tension = describe::schema_of<ident::TensionResult>();
  tension["properties"]["peaks"] = describe::schema_of<std::vector<ident::TensionPeak>>();
  tension["properties"]["steady_tones"] = describe::schema_of<std::vector<ident::TensionTone>>();
  return {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
          {"title", "results of rigfit, schema version 2"},
          {"$defs", {{"axial", std::move(axial)}, {"tension", std::move(tension)}}}};
}

}  // namespace rigfit::apps
