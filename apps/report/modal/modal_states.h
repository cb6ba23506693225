// What a modal test of the campaign file is to ident/campaign/modal/modal_model.h.
#pragma once

#include "apps/campaign_file/campaign.h"
#include "ident/campaign/modal/modal_model.h"

namespace rigfit::apps {

using ident::Instrumented;
using ident::MeasuredRow;
using ident::ModalState;
using ident::RmsError;

/// How the campaign's test was made.
[[nodiscard]] ident::TestSetup setup_of(const CampaignTest& test);

/// The scene that stands for a test, which has one.
[[nodiscard]] ident::SceneUse scene_use(const Campaign& campaign, const CampaignTest& test);

/// The rows of the test's table; empty without.
[[nodiscard]] std::vector<ident::PublishedMode> published_modes(const CampaignTest& test);

}  // namespace rigfit::apps
