// Modes of a scene against a test, tension by tension: static equilibrium, natural modes, measured
// frequencies paired with modelled ones, published models beside them.
#pragma once

#include "apps/campaign_file/campaign.h"
#include "apps/report/modal/modal_states.h"
#include "apps/report/report_part.h"

namespace rigfit::apps {

/// `known` gives EI at each tension and EA for the scene's parameters that take them.
[[nodiscard]] ReportPart modal_part(const Campaign& campaign, const CampaignTest& test,
                                    const KnownValues& known,
                                    const std::vector<ident::ModalTestState>& recorded);

}  // namespace rigfit::apps
