// What the models were given: each value of each scene with how it is known.
#pragma once

#include "apps/campaign_file/campaign.h"
#include "apps/report/page/report_part.h"

namespace rigfit::apps {

[[nodiscard]] ReportPart scenes_part(const Campaign& campaign);

/// The unit of a scene's parameter as people write it, "N m²"; empty for a ratio.
[[nodiscard]] std::string parameter_unit(const model::Scene& scene, const std::string& name);

}  // namespace rigfit::apps
