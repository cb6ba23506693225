// Modes of a scene against a test, tension by tension: static equilibrium, natural modes, measured
// frequencies paired with modelled ones, published models beside them.
#pragma once

#include "apps/campaign_file/campaign.h"
#include "apps/report/modal/modal_states.h"
#include "apps/report/page/report_part.h"

namespace rigfit::apps {

/// `states`: of the model, by rising tension; `known`: what its scene took from other tests.
[[nodiscard]] ReportPart modal_part(const Campaign& campaign, const CampaignTest& test,
                                    const ident::KnownValues& known,
                                    const std::vector<ModalState>& states);

}  // namespace rigfit::apps
