// The result of `rigfit tension` as JSON and for people: walks over its description.
#pragma once

#include <ostream>

#include "apps/cli/verb.h"
#include "ident/campaign/single_tests/tension_campaign.h"

namespace rigfit::apps {

/// A solved tension.
[[nodiscard]] Json tension_json(const ident::TensionResult& result);
/// The same with the peaks of the recordings it is found from.
[[nodiscard]] Json tension_json(const ident::TensionCampaignResult& campaign);
void print_tension(std::ostream& out, const ident::TensionResult& result);

}  // namespace rigfit::apps
