#include "apps/campaign_file/new/new_campaign.h"

#include "apps/cli/assets.h"

namespace rigfit::apps {

std::vector<std::pair<std::string_view, std::string_view>> new_campaign_files() {
  return {{"campaign.toml", assets::new_campaign_toml},
          {"scenes/cable.toml", assets::new_cable_toml},
          {"bending.csv", assets::new_bending_csv},
          {"frequencies.csv", assets::new_frequencies_csv}};
}

}  // namespace rigfit::apps
