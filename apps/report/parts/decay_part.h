// Free decays of a campaign: frequencies and damping from each record; where a scene stands for the
// test, its simulated answer laid over the record and analysed by the same estimator.
#pragma once

#include <string>
#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/fit/fit_part.h"
#include "apps/report/modal/modal_states.h"
#include "apps/report/report_part.h"

namespace rigfit::apps {

/// What a fit found that says to predict this test.
struct FitOfDecay {
  std::string title;
  std::vector<FittedValues> values;  ///< by state
};

/// `fits`: none of them has seen these decays.
[[nodiscard]] ReportPart decay_part(const Campaign& campaign, const CampaignTest& test,
                                    const KnownValues& known, const std::vector<FitOfDecay>& fits,
                                    int threads);

}  // namespace rigfit::apps
