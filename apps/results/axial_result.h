// What the axial test found, as JSON and as text for a terminal. The verb `axial` and the report's
// document hold the same JSON.
#pragma once

#include <ostream>
#include <string>

#include "apps/cli/verb.h"
#include "ident/campaign/single_tests/axial_campaign.h"

namespace rigfit::apps {

/// EA_N, damping_ratio, damping_Ns_m, alternatives, samples, lengths, budget and the rest; of a
/// test without a result the samples only.
[[nodiscard]] Json axial_json(const ident::AxialInputs& inputs,
                              const ident::AxialCampaignResult& result);

/// EA with its interval, or the bound of it, in a line.
[[nodiscard]] std::string axial_EA_text(const ident::AxialTestResult& result);

void print_axial(std::ostream& out, const ident::AxialTestResult& result);

}  // namespace rigfit::apps
