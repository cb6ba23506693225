#include "tests/bench/cable_update.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/cli/assets.h"
#include "model/scene/read_scene.h"

namespace rigfit::apps {
namespace {

model::Scene cable_at(double tension_N, int segments) {
  model::Scene scene = model::parse_scene(assets::new_cable_toml, "cable.toml");
  scene.members[0].segments = segments;
  model::set_parameter(scene, scene.members[0].name + ".tension", tension_N);
  return scene;
}

}  // namespace

CableUpdate::CableUpdate(int fine_segments)
    : fine_(fine_segments), EI_Nm2_(cable_at(200, fine_segments).members[0].EI[0]) {
  model::ModesOptions options;
  options.count = 14;
  options.shapes = options.error_estimate = false;
  for (const double tension : {100.0, 200.0}) {
    State state{tension, {}};
    for (const auto& mode : model::analyse_modes(cable_at(tension, fine_), options).modes) {
      if (mode.plane == model::ModePlane::out && state.hz.size() < 6) {
        state.hz.push_back(mode.frequency_hz);
      }
    }
    states_.push_back(std::move(state));
  }
}

ident::UpdateResult CableUpdate::fit(int segments, const ident::UpdateOptions& options) const {
  ident::FreeParameter tension{"cable.tension"};
  tension.per_state = true;
  std::vector<ident::UpdateState> states;
  for (const State& measured : states_) {
    ident::UpdateState state{fmt::format("{:g} N", measured.tension_N),
                             cable_at(1.1 * measured.tension_N, segments),
                             {}};
    state.scene.members[0].EI = {1.4 * EI_Nm2_, 1.4 * EI_Nm2_};
    for (const double hz : measured.hz) {
      ident::MeasuredMode mode;
      mode.frequency_hz = {hz, 1e-3 * hz};
      mode.plane = model::ModePlane::out;
      state.measured.push_back(mode);
    }
    states.push_back(std::move(state));
  }
  return ident::update_model(states, {{"cable.EI"}, tension}, options);
}

double CableUpdate::error_of(const ident::UpdateResult& result) const {
  if (result.status != ident::UpdateStatus::converged || result.parameters.size() != 3) return 1;
  double error = std::abs(result.parameters[0].value / EI_Nm2_ - 1);
  for (std::size_t s = 0; s < states_.size(); ++s) {
    error = std::max(error, std::abs(result.parameters[s + 1].value / states_[s].tension_N - 1));
  }
  return std::min(error, 1.0);
}

double CableUpdate::reference_error() const {
  ident::UpdateOptions options;
  options.starts = 1;
  return error_of(fit(2 * fine_ / 3, options));
}

}  // namespace rigfit::apps
