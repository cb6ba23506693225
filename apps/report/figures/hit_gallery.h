// Every hit of a hammer test as a small picture of its force pulse, accepted or rejected with the
// reason.
#pragma once

#include <string>
#include <vector>

#include "apps/report/page/report_part.h"
#include "ident/campaign/modal/hammer_test.h"

namespace rigfit::apps {

/// `places` and `test` belong together and hold their recordings. All rejected hits and the first
/// accepted ones, `most` in all; the caption says how many there are.
[[nodiscard]] Picture hit_gallery(const std::string& id,
                                  const std::vector<ident::StruckPlace>& places,
                                  const ident::HammerTest& test, Origin origin,
                                  std::size_t most = 24);

}  // namespace rigfit::apps
