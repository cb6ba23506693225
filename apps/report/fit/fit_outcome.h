// A fit of the campaign as it came out, before anything of it is shown.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/modal/modal_states.h"
#include "ident/update/model_update.h"
#include "ident/update/uncertainty/update_checks.h"

namespace rigfit::apps {

struct FittedState {
  std::size_t test = 0;  ///< of the campaign
  ModalState modal;
};

struct FitOutcome {
  const Campaign& campaign;
  const CampaignFit& fit;
  std::vector<FittedState> states = {};
  std::vector<ident::UpdateState> updates = {};  ///< by state: what was fitted to
  ident::UpdateResult result = {};
  std::vector<ident::HeldOut> held = {};  ///< empty: nothing was held out
  double rms_held_out = std::numeric_limits<double>::quiet_NaN();

  [[nodiscard]] const std::string& name_of_state(int state) const {
    return updates[static_cast<std::size_t>(state)].name;
  }
  [[nodiscard]] Origin origin_of(std::size_t state) const {
    const auto* recorded = states[state].modal.recorded;
    return recorded ? recorded->origin : Origin::published;
  }
};

}  // namespace rigfit::apps
