// Every hit of a hammer test as its force pulse, the rejected ones broken.
#pragma once

#include <string>
#include <vector>

#include "apps/report/drawing/plot.h"
#include "ident/campaign/modal/hammer_test.h"

namespace rigfit::apps {

/// `places` and `test` belong together and hold their recordings. Force over the time from the
/// begin of each pulse, offset removed and the pulse upwards; all rejected hits and the first
/// accepted ones, `most` in all. No series without hits.
[[nodiscard]] Plot hits_plot(const std::string& id, const std::vector<ident::StruckPlace>& places,
                             const ident::HammerTest& test, Origin origin, std::size_t most = 24);

}  // namespace rigfit::apps
