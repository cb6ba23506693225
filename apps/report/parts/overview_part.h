// What the first page shows besides the answers: the rig to scale, and all modes of all tests
// against the model.
#pragma once

#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/page/report_part.h"

namespace rigfit::apps {

/// `parts`: of the tests and fits. The blocks are a Picture of the largest scene that a test names
/// and a Plot; each is missing where there is nothing to draw.
[[nodiscard]] ReportPart overview_part(const Campaign& campaign,
                                       const std::vector<ReportPart>& parts);

}  // namespace rigfit::apps
