// Hammer recordings sorted for analysis: by state of the rig and place struck; what cannot take
// part is refused with its reason.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/modal/recorded_modal.h"
#include "signal/impact/impact_test.h"

namespace rigfit::apps {

/// The recordings of one state and one place struck.
struct Struck {
  std::string load;
  std::vector<signal::Recording> recordings;
  Origin origin = Origin::measured;
  std::optional<signal::ImpactTest> test;
};

struct StruckState {
  std::optional<double> tension_N;
  std::vector<Struck> struck;
};

/// Usable recordings by state, tensions rising, and place struck; the rest is refused on the part.
[[nodiscard]] std::vector<StruckState> sorted_recordings(const CampaignTest& test,
                                                         std::vector<LoadedRecording>& loaded,
                                                         ReportPart& part);

/// The responses asked for, else every channel besides the force that all recordings have.
[[nodiscard]] std::vector<std::string> response_names(const CampaignTest& test,
                                                      const std::vector<Struck>& struck);

[[nodiscard]] signal::ImpactTestOptions impact_options(const CampaignTest& test);

/// FRFs of several places struck as one set; their lines agree.
[[nodiscard]] signal::FrfSet merged(const std::vector<Struck>& struck);

/// The first accepted hit, for laying the model's answer over it.
[[nodiscard]] RecordedHit recorded_hit(const Struck& struck, const std::string& force);

}  // namespace rigfit::apps
