#include "apps/results/axial_result.h"

#include "apps/describe/sheet.h"

namespace rigfit::apps {

Json axial_json(const ident::AxialInputs& inputs, const ident::AxialCampaignResult& result) {
  Json out = result.test ? describe::json_of(*result.test) : Json::object();
  out["samples"] = describe::json_of(ident::axial_records(inputs, result));
  return out;
}

void print_axial(std::ostream& out, const ident::AxialTestResult& result) {
  describe::print(out, describe::sheet_of(result));
}

}  // namespace rigfit::apps
