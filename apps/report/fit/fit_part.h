// A fit of the campaign: what was fitted to which tests, what came out with which uncertainty, and
// what it is worth: errors before, after and of states held out, shapes, FRFs and answers in time
// laid over the test.
#pragma once

#include <cstdint>
#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/page/report_part.h"
#include "ident/campaign/campaign.h"

namespace rigfit::apps {

/// `modal_tests`: the campaign's modal tests, in the order of CampaignInputs::modal.
[[nodiscard]] ident::FitInputs fit_inputs(const CampaignFit& fit,
                                          const std::vector<std::size_t>& modal_tests,
                                          std::uint64_t seed, int threads);

[[nodiscard]] ReportPart fit_part(const Campaign& campaign, const CampaignFit& fit,
                                  const std::vector<std::size_t>& modal_tests,
                                  const ident::CampaignFitOutcome& answer);

}  // namespace rigfit::apps
