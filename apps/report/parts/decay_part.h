// Free decays of a campaign: frequencies and damping from each record; where a scene stands for the
// test, its simulated answer laid over the record and analysed by the same estimator.
#pragma once

#include <memory>

#include "apps/report/page/test_part.h"

namespace rigfit::apps {

[[nodiscard]] std::unique_ptr<TestPart> decay_part(const Campaign& campaign,
                                                   const CampaignTest& test);

}  // namespace rigfit::apps
