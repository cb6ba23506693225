// The campaign reader, fed with seeds, with regressions of faults found by fuzzing and with
// mutations of both, gives a campaign whose parts are there, or a reason.
#include <gtest/gtest.h>

#include "tests/fuzz/mutations.h"
#include "tests/fuzz/require_campaign.h"

namespace rigfit::apps::malformed_campaign_test {
namespace {

const std::filesystem::path kPath = RIGFIT_FUZZ "/campaign_folder/campaign.toml";

TEST(MalformedCampaign, SeedsAndMutationsGiveACampaignOrAReason) {
  const auto seeds = seeds_of("campaign");
  ASSERT_GE(seeds.size(), 3u);
  std::mt19937_64 random(20260403);
  for (const auto& seed : seeds) {
    EXPECT_NO_THROW(require_campaign_or_reason(seed.bytes, kPath)) << seed.name;
    for (int k = 0; k < 2000; ++k) {
      const std::string bytes = mutated(seed.bytes, toml_words(), random);
      EXPECT_NO_THROW(require_campaign_or_reason(bytes, kPath))
          << seed.name << ", mutation " << k << ":\n"
          << bytes;
    }
  }
}

TEST(MalformedCampaign, SeedsAreCampaigns) {
  for (const auto& seed : seeds_of("campaign")) {
    if (!std::filesystem::exists(RIGFIT_FUZZ "/seeds/campaign/" + seed.name)) continue;
    EXPECT_NO_THROW(require_sound(parse_campaign(seed.bytes, kPath))) << seed.name;
  }
}

}  // namespace
}  // namespace rigfit::apps::malformed_campaign_test
