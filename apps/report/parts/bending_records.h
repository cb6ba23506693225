// Load-deflection records of a bending test: read, and listed.
#pragma once

#include <functional>
#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/page/report_part.h"
#include "ident/campaign/single_tests/bending_campaign.h"

namespace rigfit::apps {

/// What is analysed, and where each source comes from.
struct BendingTests {
  ident::BendingCampaign campaign;
  std::vector<Origin> origins;  ///< of the sources
};

/// The recordings of a test, with a call of `file_read` after each; those that cannot be used are
/// refused on the part.
[[nodiscard]] BendingTests recorded_tests(const CampaignTest& test,
                                          const std::function<void()>& file_read, ReportPart& part);

/// What was found in the records of each point, as warnings and refusals.
void add_findings(const ident::BendingCampaign& campaign,
                  const ident::BendingCampaignResult& result, ReportPart& part);

/// EI from each record with what was remarked. `origins`: of the campaign's sources.
[[nodiscard]] ReportTable bending_records_table(const CampaignTest& test,
                                                const ident::BendingCampaign& campaign,
                                                const std::vector<Origin>& origins,
                                                const ident::BendingCampaignResult& result);

}  // namespace rigfit::apps
