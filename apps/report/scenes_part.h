// What the models were given: each value of each scene with how it is known.
#pragma once

#include "apps/campaign.h"
#include "apps/report/report_part.h"

namespace rigfit::apps {

[[nodiscard]] ReportPart scenes_part(const Campaign& campaign);

}  // namespace rigfit::apps
