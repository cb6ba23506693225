// What the axial test found, as JSON and as text: walks over its description. The verb `axial` and
// the report's document hold the same JSON.
#pragma once

#include <ostream>

#include "apps/cli/verb.h"
#include "ident/campaign/single_tests/axial_campaign.h"

namespace rigfit::apps {

/// The test's fields and `samples`; of a test without a result the samples only.
[[nodiscard]] Json axial_json(const ident::AxialInputs& inputs,
                              const ident::AxialCampaignResult& result);
void print_axial(std::ostream& out, const ident::AxialTestResult& result);

}  // namespace rigfit::apps
