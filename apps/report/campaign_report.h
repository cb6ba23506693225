// The main job: everything a campaign names, computed part by part and written as one report.
#pragma once

#include <filesystem>

#include "apps/campaign_file/campaign.h"
#include "apps/cli/verb.h"
#include "apps/report/report_files.h"

namespace rigfit::apps {

/// Computes every part (on `context.threads` threads), writes report.html, report.json, data/ and
/// figures/ under `folder`, and returns the result as in report.json without its envelope.
[[nodiscard]] Json campaign_report(const Campaign& campaign, const std::filesystem::path& folder,
                                   const ReportOptions& options, VerbContext& context);

}  // namespace rigfit::apps
