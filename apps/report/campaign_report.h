// The main job: everything a campaign names, computed part by part and written as one report.
#pragma once

#include <filesystem>

#include "apps/campaign/campaign.h"
#include "apps/cli/verb.h"
#include "apps/report/report_files.h"

namespace rigfit::apps {

/// Computes every part (on `context.threads` threads), writes report.html, report.json, data/ and
/// figures/ under `folder`, and returns the result as in report.json without its envelope;
/// `given`: gets its answers.
[[nodiscard]] Json campaign_report(const Campaign& campaign, const std::filesystem::path& folder,
                                   const ReportOptions& options, VerbContext& context,
                                   std::vector<Answer>* given = nullptr);

/// Two campaigns, before and after (compare_reports.h): each reported under `folder` in a folder of
/// its own, before/ and after/, and the comparison as report.html and report.json.
[[nodiscard]] Json compared_campaigns(const Campaign& before, const Campaign& after,
                                      const std::filesystem::path& folder,
                                      const ReportOptions& options, VerbContext& context);

}  // namespace rigfit::apps
