// Load-deflection records of a bending test, listed.
#pragma once

#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/report_part.h"
#include "ident/campaign/bending_campaign.h"

namespace rigfit::apps {

/// EI from each record with what was remarked. `origins`: of the campaign's sources.
[[nodiscard]] ReportTable bending_records_table(const CampaignTest& test,
                                                const ident::BendingCampaign& campaign,
                                                const std::vector<Origin>& origins,
                                                const ident::BendingCampaignResult& result);

}  // namespace rigfit::apps
