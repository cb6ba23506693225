// Hits as JSON, the same in every document.
#pragma once

#include "apps/cli/json_document.h"
#include "ident/campaign/modal/hammer_campaign.h"

namespace rigfit::apps {

/// The hits of one place struck, accepted and rejected.
[[nodiscard]] Json hits_json(const ident::StruckPlace& place, const signal::ImpactTest& test);

/// `force_window`: length kept, who chose it, the noise on the force before and after; of several
/// places struck the largest of each.
[[nodiscard]] Json force_window_json(const ident::HammerTest& hammer);

}  // namespace rigfit::apps
