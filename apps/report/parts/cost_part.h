// What the models of a report did, left out and took.
#pragma once

#include <vector>

#include "apps/report/page/report_part.h"

namespace rigfit::apps {

/// Costs of all parts. Times are of this machine and differ from run to run: they are on the page,
/// not in the document.
[[nodiscard]] ReportPart cost_part(const std::vector<ReportPart>& parts);

}  // namespace rigfit::apps
