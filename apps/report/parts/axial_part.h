// The hanging-mass test of a campaign: EA, damping and damper from its recordings, length by
// length, with the uncertainty budget.
#pragma once

#include <memory>

#include "apps/report/page/test_part.h"

namespace rigfit::apps {

[[nodiscard]] std::unique_ptr<TestPart> axial_part(const CampaignTest& test, int threads);

}  // namespace rigfit::apps
