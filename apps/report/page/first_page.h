// The first page of a report: who made it and for whom, what was tested, the answers with verdicts,
// model against test in one figure, the most serious warnings. One page on paper.
#pragma once

#include <span>
#include <string>

#include "apps/report/page/block_html.h"
#include "apps/report/page/findings.h"
#include "apps/report/page/page_frame.h"
#include "apps/report/page/report_part.h"

namespace rigfit::apps {

[[nodiscard]] std::string first_page(const PageFrame& frame, const ReportPart& overview,
                                     std::span<const ReportPart> parts,
                                     std::span<const ReportFinding> findings, BlockHtml& blocks);

}  // namespace rigfit::apps
