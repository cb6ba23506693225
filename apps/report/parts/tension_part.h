// The tension of a cable of a campaign from its frequencies: recordings, modes by order, kinds of
// ends with their weights, formulas of the literature beside it, uncertainty budget.
#pragma once

#include "apps/campaign_file/campaign.h"
#include "apps/report/report_part.h"

namespace rigfit::apps {

[[nodiscard]] ReportPart tension_part(const CampaignTest& test);

}  // namespace rigfit::apps
