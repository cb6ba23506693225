// Modes of a scene against a test, tension by tension: static equilibrium, natural modes, measured
// frequencies paired with modelled ones, published models beside them.
#pragma once

#include "apps/campaign.h"
#include "apps/report/bending_part.h"
#include "apps/report/report_part.h"

namespace rigfit::apps {

/// `EI` gives the bending stiffness at each tension for the scene's parameters in `test.EI_of`.
[[nodiscard]] ReportPart modal_part(const Campaign& campaign, const CampaignTest& test,
                                    const StiffnessCurve& EI);

}  // namespace rigfit::apps
