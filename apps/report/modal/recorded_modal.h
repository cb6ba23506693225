// The recordings of a modal test (ident/campaign/modal_test.h) as a part of the report: what could
// be used, what could not and why, FRFs and modes state by state.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/report_part.h"
#include "ident/campaign/modal_test.h"

namespace rigfit::apps {

struct RecordedModal {
  ReportPart part;
  std::vector<ident::ModalTestState> states;  ///< those that gave modes, by rising tension
};

[[nodiscard]] RecordedModal recorded_modal(const Campaign& campaign, const CampaignTest& test);

/// "200 N", or "as built" without a tension.
[[nodiscard]] std::string state_label(std::optional<double> tension_N);

}  // namespace rigfit::apps
