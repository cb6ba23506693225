// A bending test of beams without tension, by dead weights or a testing machine: EI and modulus of
// each specimen, by ident/campaign/single_tests/bending_campaign.h.
#pragma once

#include <memory>

#include "apps/report/page/test_part.h"

namespace rigfit::apps {

/// `test.beam` is there.
[[nodiscard]] std::unique_ptr<TestPart> beam_part(const CampaignTest& test);

}  // namespace rigfit::apps
