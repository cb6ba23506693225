// EI of a strand against its tension: the bending equation solved at each tension, laws through the
// points, bounds from the strand's geometry.
#pragma once

#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/report_part.h"

namespace rigfit::apps {

/// EI at the tensions tested, by rising tension; between them linear, outside the nearest one.
struct StiffnessCurve {
  std::vector<double> tension_N, EI_Nm2;
  [[nodiscard]] bool empty() const { return tension_N.empty(); }
  [[nodiscard]] double at(double tension) const;
};

struct BendingPart {
  ReportPart part;
  StiffnessCurve curve;
};

[[nodiscard]] BendingPart bending_part(const Campaign& campaign, const CampaignTest& test);

}  // namespace rigfit::apps
