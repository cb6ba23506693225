// A bending test as figures: load over deflection, EI over tension with the laws that compete.
#pragma once

#include <string>
#include <vector>

#include "apps/report/drawing/plot.h"
#include "ident/campaign/single_tests/bending_campaign.h"

namespace rigfit::apps {

/// The records of every point that was analysed; `origins` by source.
[[nodiscard]] Plot load_deflection_plot(const std::string& id,
                                        const ident::BendingCampaign& campaign,
                                        const std::vector<Origin>& origins,
                                        const ident::BendingCampaignResult& result);

/// EI of the usable points with 95 % intervals, a series for each origin.
[[nodiscard]] std::vector<PlotSeries> stiffness_series(const ident::BendingCampaignResult& result,
                                                       const std::vector<Origin>& origins);

/// Laws that converged (the closest full, with its 95 % band), bounds and points.
[[nodiscard]] Plot stiffness_plot(const std::string& id, const std::vector<PlotSeries>& points,
                                  const ident::BendingCampaignResult& result);

}  // namespace rigfit::apps
