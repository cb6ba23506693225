// JSON of bending tests: the same from the verb and from the report of a campaign.
#pragma once

#include "apps/cli/verb.h"
#include "ident/campaign/single_tests/bending_campaign.h"

namespace rigfit::apps {

/// `tests[], laws[], law_choice, curve, bounds`.
[[nodiscard]] Json bending_json(const ident::BendingCampaign& campaign,
                                const ident::BendingCampaignResult& result);

}  // namespace rigfit::apps
