// The hanging-mass test of a campaign: EA, damping and damper from its recordings, length by
// length, with the uncertainty budget.
#pragma once

#include <optional>

#include "apps/campaign_file/campaign.h"
#include "apps/report/report_part.h"
#include "ident/campaign/axial_campaign.h"

namespace rigfit::apps {

struct AxialPart {
  ReportPart part;
  std::optional<ident::AxialKnowledge> known;
};

[[nodiscard]] AxialPart axial_part(const CampaignTest& test, std::uint64_t seed, int threads);

}  // namespace rigfit::apps
