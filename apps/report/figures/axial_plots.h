// An axial test as figures: EA by length, the decays, where the uncertainty of EA comes from.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/report/page/report_part.h"
#include "ident/campaign/single_tests/axial_campaign.h"

namespace rigfit::apps {

/// A value to compare with.
struct ReferenceValue {
  std::string name;  ///< "published", "truth"
  Origin origin = Origin::published;
  double value = 0;
};

/// EA at each length, of each record, and the result with its 95 % band.
[[nodiscard]] Plot axial_length_plot(const std::string& id, const ident::AxialTestResult& result,
                                     Origin origin,
                                     const std::optional<ReferenceValue>& reference = std::nullopt);

/// The first decay of each length with its fit and residual, a tab a length, and damping over
/// amplitude. `origins` by recording. Ids are `id` with "-decays", "-decay-0.7m", "-damping".
[[nodiscard]] std::vector<Block> axial_decay_blocks(const std::string& id,
                                                    const ident::AxialInputs& inputs,
                                                    const ident::AxialCampaignResult& result,
                                                    const std::vector<Origin>& origins);

}  // namespace rigfit::apps
