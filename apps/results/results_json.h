// What tests and fits found, as JSON: walks over the descriptions of the results. The verbs and the
// report's document hold the same.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/cli/json_document.h"
#include "apps/cli/verb.h"
#include "ident/campaign/modal/hammer_campaign.h"
#include "ident/campaign/single_tests/axial_campaign.h"
#include "ident/campaign/single_tests/bending_campaign.h"

namespace rigfit::apps {

/// The test's fields and `samples`; of a test without a result the samples only.
[[nodiscard]] Json axial_json(const ident::AxialCampaignResult& result);

/// `tests[], laws[], law_choice, curve, bounds`.
[[nodiscard]] Json bending_json(const ident::BendingCampaign& campaign,
                                const ident::BendingCampaignResult& result);

/// The hits of one place struck, accepted and rejected.
[[nodiscard]] Json hits_json(const ident::StruckPlace& place, const signal::ImpactTest& test);

}  // namespace rigfit::apps
