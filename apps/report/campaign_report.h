// The main job: everything a campaign names, computed part by part and written as one report.
#pragma once

#include <filesystem>

#include "apps/campaign_file/campaign.h"
#include "apps/cli/verb.h"

namespace rigfit::apps {

/// Computes every part (on `context.threads` threads), writes report.html, report.json, data/ and
/// figures/ under `folder`, and returns the result as in report.json without its envelope.
[[nodiscard]] Json campaign_report(const Campaign& campaign, const std::filesystem::path& folder,
                                   VerbContext& context);

}  // namespace rigfit::apps
