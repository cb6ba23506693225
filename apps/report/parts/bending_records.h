// EI from load-deflection recordings: one point a recording, with interval, or a reason why there
// is none.
#pragma once

#include <string>
#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/report_part.h"
#include "ident/bending/bending_test.h"

namespace rigfit::apps {

struct BendingRecordResult {
  std::string file;
  Origin origin = Origin::measured;
  ident::BendingRecord record;
  ident::BendingTestResult result;
};

/// Analyses every usable recording of the test (by rising tension); those that cannot be used are
/// refused on the part.
[[nodiscard]] std::vector<BendingRecordResult> bending_records(
    const CampaignTest& test, const std::vector<LoadedRecording>& loaded, ReportPart& part);

/// Load against deflection with the lines of each stroke.
[[nodiscard]] Plot load_deflection_plot(const CampaignTest& test,
                                        const std::vector<BendingRecordResult>& records);
[[nodiscard]] ReportTable bending_records_table(const CampaignTest& test,
                                                const std::vector<BendingRecordResult>& records);
[[nodiscard]] Json bending_record_json(const BendingRecordResult& record);

}  // namespace rigfit::apps
