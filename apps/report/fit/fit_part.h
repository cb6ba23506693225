// A fit of the campaign: what was fitted to which tests, what came out with which uncertainty, and
// what it is worth: errors before, after and of states held out, shapes, FRFs and answers in time
// laid over the test.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/modal/modal_states.h"
#include "apps/report/report_part.h"

namespace rigfit::apps {

struct FittedValue {
  std::string parameter;  ///< of the scene
  double value = 0;
  bool shared = false;  ///< by all states
};

/// What a fit found of the scene's parameters in one state.
struct FittedValues {
  std::optional<double> tension_N;
  std::vector<FittedValue> values;
};

struct FitPart {
  ReportPart part;
  std::vector<FittedValues> values;  ///< by state; empty when it did not converge
};

/// `recorded`: by test of the campaign (empty for tests without recordings).
[[nodiscard]] FitPart fit_part(const Campaign& campaign, const CampaignFit& fit,
                               const KnownValues& known,
                               const std::vector<std::vector<ident::ModalTestState>>& recorded,
                               int threads, std::uint64_t seed);

}  // namespace rigfit::apps
