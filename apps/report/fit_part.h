// A fit of the campaign: what was fitted to which tests, what came out with which uncertainty, and
// what it is worth: errors before, after and of states held out, shapes, FRFs and answers in time
// laid over the test.
#pragma once

#include <vector>

#include "apps/campaign.h"
#include "apps/report/modal_states.h"
#include "apps/report/report_part.h"

namespace rigfit::apps {

/// `recorded`: by test of the campaign (empty for tests without recordings).
[[nodiscard]] ReportPart fit_part(const Campaign& campaign, const CampaignFit& fit,
                                  const KnownValues& known,
                                  const std::vector<std::vector<RecordedModalState>>& recorded,
                                  int threads, std::uint64_t seed);

}  // namespace rigfit::apps
