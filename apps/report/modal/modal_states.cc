#include "apps/report/modal/modal_states.h"

#include <limits>

namespace rigfit::apps {

ident::TestSetup setup_of(const CampaignTest& test) {
  return {test.direction, test.hammer.sensors, test.plane()};
}

model::Scene scene_at(const Campaign& campaign, const CampaignTest& test, const KnownValues& known,
                      std::optional<double> tension_N) {
  model::Scene scene = campaign.scenes[*test.scene].scene;
  if (known.axial) ident::apply_axial(*known.axial, test.EA_of, test.damping_of, scene);
  if (!tension_N) return scene;
  for (const auto& name : test.tension_of) model::set_parameter(scene, name, *tension_N);
  if (!known.EI.empty()) {
    for (const auto& name : test.EI_of)
      model::set_parameter(scene, name, known.EI.at(*tension_N).EI_Nm2);
  }
  return scene;
}

std::vector<ModalState> modal_states(const Campaign& campaign, const CampaignTest& test,
                                     const KnownValues& known,
                                     const std::vector<ident::ModalTestState>& recorded) {
  std::vector<ident::PublishedMode> published;
  if (test.results) {
    const auto& results = *test.results;
    for (const auto& values : results.table.rows) {
      ident::PublishedMode mode;
      if (results.tension) mode.tension_N = values[*results.tension];
      mode.measured_hz =
          results.measured ? values[*results.measured] : std::numeric_limits<double>::quiet_NaN();
      for (const auto& [label, column] : results.models) mode.models_hz.push_back(values[column]);
      published.push_back(std::move(mode));
    }
  }
  const auto at = [&](std::optional<double> tension_N) {
    ident::SceneOfState state{scene_at(campaign, test, known, tension_N), {}};
    if (tension_N && !known.EI.empty() && !test.EI_of.empty()) {
      state.EI_Nm2 = known.EI.at(*tension_N).EI_Nm2;
    }
    return state;
  };
  return ident::modal_states(setup_of(test), at, recorded, published);
}

}  // namespace rigfit::apps
