// EI of a strand against its tension: tests, laws through the points, bounds from the strand's
// geometry, by ident/campaign/single_tests/bending_campaign.h.
#pragma once

#include <memory>

#include "apps/report/page/test_part.h"

namespace rigfit::apps {

[[nodiscard]] std::unique_ptr<TestPart> bending_part(const Campaign& campaign,
                                                     const CampaignTest& test);

}  // namespace rigfit::apps
