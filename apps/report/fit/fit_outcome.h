// A fit of the campaign as it came out, before anything of it is shown.
#pragma once

#include <string>
#include <vector>

#include "apps/campaign_file/campaign.h"
#include "ident/campaign/campaign.h"

namespace rigfit::apps {

struct FitOutcome {
  const Campaign& campaign;
  const CampaignFit& fit;
  const std::vector<std::size_t>& modal_tests;  ///< of the campaign, by CampaignResult::modal
  const ident::CampaignFitOutcome& answer;
  const std::vector<ident::FittedState>& states = answer.states;
  const std::vector<ident::UpdateState>& updates = answer.task.states;  ///< what was fitted to
  const ident::UpdateResult& result = answer.outcome.result;
  const std::vector<ident::HeldOut>& held = answer.outcome.held;  ///< empty: nothing was held out

  [[nodiscard]] const std::string& name_of_state(int state) const {
    return updates[static_cast<std::size_t>(state)].name;
  }
  [[nodiscard]] Origin origin_of(std::size_t state) const {
    const auto* recorded = states[state].modal->recorded;
    return recorded ? recorded->origin : Origin::published;
  }
  [[nodiscard]] const CampaignTest& test_of(std::size_t state) const {
    return campaign.tests[modal_tests[states[state].test]];
  }
};

}  // namespace rigfit::apps
