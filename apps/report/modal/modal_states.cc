#include "apps/report/modal/modal_part.h"

#include <limits>

namespace rigfit::apps {

ident::TestSetup setup_of(const CampaignTest& test) {
  return {test.direction, test.hammer.sensors, test.plane()};
}

ident::SceneUse scene_use(const Campaign& campaign, const CampaignTest& test) {
  return {campaign.scenes[*test.scene].scene, test.tension_of, test.EI_of, test.EA_of,
          test.damping_of};
}

std::vector<ident::PublishedMode> published_modes(const CampaignTest& test) {
  std::vector<ident::PublishedMode> published;
  if (!test.results) return published;
  const auto& results = *test.results;
  for (const auto& values : results.table.rows) {
    ident::PublishedMode mode;
    if (results.tension) mode.tension_N = values[*results.tension];
    mode.measured_hz =
        results.measured ? values[*results.measured] : std::numeric_limits<double>::quiet_NaN();
    for (const auto& [label, column] : results.models) mode.models_hz.push_back(values[column]);
    published.push_back(std::move(mode));
  }
  return published;
}

}  // namespace rigfit::apps
