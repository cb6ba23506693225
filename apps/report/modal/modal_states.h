// The scene of a campaign's test at a state of it, and the modal test against it
// (ident/campaign/modal_model.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/modal/recorded_modal.h"
#include "ident/bending/stiffness_curve.h"
#include "ident/campaign/axial_campaign.h"
#include "ident/campaign/modal_model.h"

namespace rigfit::apps {

/// What the scenes take from tests made before.
struct KnownValues {
  ident::StiffnessCurve EI;
  std::optional<ident::AxialKnowledge> axial;
};

using ident::Instrumented;
using ident::MeasuredRow;
using ident::ModalState;
using ident::RmsError;

/// How the campaign's test was made.
[[nodiscard]] ident::TestSetup setup_of(const CampaignTest& test);

/// Modes of the scene at every state of the test (ident/campaign/modal_model.h). `recorded` must
/// outlive the result.
[[nodiscard]] std::vector<ModalState> modal_states(
    const Campaign& campaign, const CampaignTest& test, const KnownValues& known,
    const std::vector<ident::ModalTestState>& recorded);

/// The scene as the test has it at one tension.
[[nodiscard]] model::Scene scene_at(const Campaign& campaign, const CampaignTest& test,
                                    const KnownValues& known, std::optional<double> tension_N);

}  // namespace rigfit::apps
