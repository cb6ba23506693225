// Free decays of a campaign: frequencies and damping from each record; where a scene stands for the
// test, its simulated answer laid over the record and analysed by the same estimator.
#pragma once

#include "apps/campaign.h"
#include "apps/report/modal_states.h"
#include "apps/report/report_part.h"

namespace rigfit::apps {

[[nodiscard]] ReportPart decay_part(const Campaign& campaign, const CampaignTest& test,
                                    const KnownValues& known);

}  // namespace rigfit::apps
