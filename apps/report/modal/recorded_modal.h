// A modal test as parts of the report: recordings of hits (ident/campaign/modal/modal_test.h), what
// could be used, what could not and why, FRFs and modes state by state; then the model against
// them.
#pragma once

#include <memory>

#include "apps/report/page/test_part.h"

namespace rigfit::apps {

[[nodiscard]] std::unique_ptr<TestPart> modal_test_part(const Campaign& campaign,
                                                        const CampaignTest& test);

}  // namespace rigfit::apps
