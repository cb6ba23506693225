// EI of a strand against its tension: tests, laws through the points, bounds from the strand's
// geometry, by ident/campaign/bending_campaign.h.
#pragma once

#include "apps/campaign_file/campaign.h"
#include "apps/report/report_part.h"
#include "ident/bending/stiffness_curve.h"

namespace rigfit::apps {

struct BendingPart {
  ReportPart part;
  ident::StiffnessCurve curve;
};

[[nodiscard]] BendingPart bending_part(const Campaign& campaign, const CampaignTest& test);

}  // namespace rigfit::apps
