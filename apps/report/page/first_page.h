// The first page of a report: who made it and for whom, what was tested, the answers with verdicts,
// model against test in one figure, the most serious warnings. One page on paper.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "apps/report/page/block_html.h"
#include "apps/report/page/page_frame.h"

namespace rigfit::apps {

[[nodiscard]] std::string first_page(const PageFrame& frame, const ReportPart& overview,
                                     std::span<const ReportPart> parts, BlockHtml& blocks);

/// What is not to be trusted, the most serious first, one of each kind, one sentence each.
struct SeriousWarning {
  std::string label, sentence, anchor;
  std::size_t alike = 0;  ///< how many others of its kind there are
};
[[nodiscard]] std::vector<SeriousWarning> serious_warnings(std::span<const ReportPart> parts);

/// A list item of the page.
[[nodiscard]] std::string warning_line(const SeriousWarning& warning);

}  // namespace rigfit::apps
