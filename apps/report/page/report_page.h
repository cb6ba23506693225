// A report as one HTML page that needs nothing else: style, scripts, data and pictures are in it.
//
// First page (who made it and for whom, what was tested, the answers with verdicts, model against
// test, the most serious warnings), short report by test, appendix with everything else. On paper
// the first two take eight pages at most.
#pragma once

#include <span>

#include "apps/campaign/campaign.h"
#include "apps/cli/warning_lines.h"
#include "apps/report/page/report_part.h"

namespace rigfit::apps {

/// Whom the report is for: a client gets the short report and the appendix as a page of its own,
/// a laboratory one page of both.
enum class ReportStyle { lab, client };

/// What frames the parts of a report.
struct PageFrame {
  std::string title, source, description;
  ReportDetails details = {};
  ReportStyle style = ReportStyle::lab;
  std::string repeat = {};  ///< command line that makes the report again
  std::vector<std::pair<std::string, std::string>> inputs = {};  ///< path, SHA-256
  std::vector<std::pair<std::string, std::string>> links = {};   ///< other pages: file, title
  ReportTable times = {
      "times", "Time of each stage of this report.", {{"stage", {}, false}, {"time, s"}}};
};

/// report.html. `overview` (parts/parts.h) stands on the first page.
[[nodiscard]] std::string report_page(const PageFrame& frame, const ReportPart& overview,
                                      std::span<const ReportPart> parts);
/// appendix.html of a client's report.
[[nodiscard]] std::string appendix_page(const PageFrame& frame, std::span<const ReportPart> parts);

/// What the parts found, as it is told.
[[nodiscard]] std::vector<FindingKind> findings_of(std::span<const ReportPart> parts);

}  // namespace rigfit::apps
