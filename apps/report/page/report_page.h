// A report as one HTML page.
#pragma once

#include <span>
#include <string>

#include "apps/report/page/page_frame.h"
#include "apps/report/page/report_part.h"

namespace rigfit::apps {

// A report as one HTML page that needs nothing else: style, scripts, data and pictures are in it.
//
// First page (what was tested, the answers, model against test, the most serious warnings), short
// report by test, appendix with everything else. On paper the first two take eight pages at most.

/// report.html. `overview` (parts/overview_part.h) stands on the first page.
[[nodiscard]] std::string report_page(const PageFrame& frame, const ReportPart& overview,
                                      std::span<const ReportPart> parts);
/// appendix.html of a client's report.
[[nodiscard]] std::string appendix_page(const PageFrame& frame, std::span<const ReportPart> parts);

}  // namespace rigfit::apps
