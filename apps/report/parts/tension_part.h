// The tension of a cable of a campaign from its frequencies: recordings, modes by order, kinds of
// ends with their weights, formulas of the literature beside it, uncertainty budget.
#pragma once

#include <memory>

#include "apps/report/page/test_part.h"

namespace rigfit::apps {

[[nodiscard]] std::unique_ptr<TestPart> tension_part(const CampaignTest& test);

}  // namespace rigfit::apps
