// What the models of a report did, left out and took: speed beside estimated error.
#pragma once

#include <vector>

#include "apps/report/report_part.h"

namespace rigfit::apps {

/// Costs of all parts, behind `speed`: how time and error go with the number of segments
/// (speed_part.h). Times are of this machine and differ from run to run: they are on the page and
/// in data/, not in the document.
[[nodiscard]] ReportPart cost_part(std::vector<Block> speed, const std::vector<ReportPart>& parts);

}  // namespace rigfit::apps
