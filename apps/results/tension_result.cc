#include "apps/results/tension_result.h"

#include "apps/describe/sheet.h"

namespace rigfit::apps {

Json tension_json(const ident::TensionResult& result) { return describe::json_of(result); }

Json tension_json(const ident::TensionCampaignResult& campaign) {
  Json json = tension_json(campaign.result.tension);
  if (!campaign.peaks.empty()) json["peaks"] = describe::json_of(campaign.peaks);
  if (!campaign.tones.empty()) json["steady_tones"] = describe::json_of(campaign.tones);
  return json;
}

void print_tension(std::ostream& out, const ident::TensionResult& result) {
  describe::print(out, describe::sheet_of(result));
}

}  // namespace rigfit::apps
