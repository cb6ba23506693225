// The main job: everything a campaign names, computed part by part and written as one report.
#pragma once

#include "apps/campaign/campaign.h"
#include "apps/cli/verb.h"
#include "apps/report/drawing/plot.h"
#include "apps/report/page/report_page.h"

namespace rigfit::apps {

struct ReportOptions {
  ReportStyle style = ReportStyle::lab;
  bool pdf = false;    ///< report.pdf (and appendix.pdf) beside the page
  SvgOptions figures;  ///< size and font of the figures for papers
  bool force = false;  ///< another campaign's report in the folder may be replaced
};

/// Computes every part (on `context.threads` threads), writes report.html, report.json, data/ and
/// figures/ under `folder`, and returns the result as in report.json without its envelope;
/// `given`: gets its answers.
[[nodiscard]] Json campaign_report(const Campaign& campaign, const std::filesystem::path& folder,
                                   const ReportOptions& options, VerbContext& context,
                                   std::vector<Answer>* given = nullptr);

/// The schema of what both give; parts of a campaign are lists of what its verbs give.
[[nodiscard]] Json report_schema();

/// Two campaigns, before and after: each reported under `folder` in a folder of
/// its own, before/ and after/, and the comparison as report.html and report.json.
[[nodiscard]] Json compared_campaigns(const Campaign& before, const Campaign& after,
                                      const std::filesystem::path& folder,
                                      const ReportOptions& options, VerbContext& context);

/// Two campaigns beside each other, before and after: what changed beyond its uncertainty. Values
/// of the same key (apps/report/page/answer.h) are compared; of several, such as the modes of a
/// state, the nearest ones. A difference has the variance of both values; what both campaigns share
/// (a span, a load cell) makes its real uncertainty smaller than that.
struct ComparedReport {
  const Campaign& campaign;
  std::vector<Answer> answers = {};
};

/// The comparison as a part: a table, a figure, JSON under "comparison" with, by value,
/// `before, after {value, std}, change, change_std, verdict`. A verdict says "changed" from three
/// standard uncertainties of the difference on, "perhaps changed" from 1.96 on.
[[nodiscard]] ReportPart compare_reports(const ComparedReport& before, const ComparedReport& after);
/// The schema of that list.
[[nodiscard]] Json comparison_schema();

}  // namespace rigfit::apps
