// Speed against error in a report: the studies of `bench` on the campaign's own scenes.
#pragma once

#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/report_part.h"

namespace rigfit::apps {

/// For every scene a chart of time against the error of its first natural frequencies, by method
/// and number of segments, against a converged reference; and a table of the defaults. Scenes that
/// differ only in their tension or name cost as much again, so the first of each set of members
/// stands for the rest.
[[nodiscard]] std::vector<Block> speed_blocks(const Campaign& campaign);

}  // namespace rigfit::apps
