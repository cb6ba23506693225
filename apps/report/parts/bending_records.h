// Load-deflection records of a bending test, drawn and listed.
#pragma once

#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/report_part.h"
#include "ident/campaign/bending_campaign.h"

namespace rigfit::apps {

/// Load against deflection of every record. `origins`: of the campaign's sources.
[[nodiscard]] Plot load_deflection_plot(const CampaignTest& test,
                                        const ident::BendingCampaign& campaign,
                                        const std::vector<Origin>& origins,
                                        const ident::BendingCampaignResult& result);
[[nodiscard]] ReportTable bending_records_table(const CampaignTest& test,
                                                const ident::BendingCampaign& campaign,
                                                const std::vector<Origin>& origins,
                                                const ident::BendingCampaignResult& result);

}  // namespace rigfit::apps
