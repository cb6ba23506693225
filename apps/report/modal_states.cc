#include "apps/report/modal_states.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace rigfit::apps {
namespace {

/// Pairs the measured rows with the modes of the model.
void pair_rows(const CampaignTest& test, ModalState& state) {
  std::vector<ident::PairingMode> measured, modelled;
  std::vector<std::size_t> row_of;
  for (std::size_t i = 0; i < state.rows.size(); ++i) {
    if (!std::isfinite(state.rows[i].measured_hz)) continue;
    ident::PairingMode mode;
    mode.frequency_hz = state.rows[i].measured_hz;
    if (test.in_plane != test.out_of_plane) {
      mode.plane = test.in_plane ? model::ModePlane::in : model::ModePlane::out;
    }
    measured.push_back(std::move(mode));
    row_of.push_back(i);
  }
  for (const auto& mode : state.analysis.modes) {
    modelled.push_back({mode.frequency_hz, mode.plane, {}, 1});
  }
  if (measured.empty() || modelled.empty()) return;
  state.pairing = ident::pair_modes(measured, modelled);
  for (const auto& pair : state.pairing.pairs) {
    auto& row = state.rows[row_of[static_cast<std::size_t>(pair.measured)]];
    row.mode = static_cast<std::size_t>(pair.model);
    row.other_plane = pair.cross_plane;
  }
}

RmsError rms(double sum, int rows) {
  return {rows > 0 ? std::sqrt(sum / rows) : std::numeric_limits<double>::quiet_NaN(), rows};
}

}  // namespace

model::Scene scene_at(const Campaign& campaign, const CampaignTest& test, const StiffnessCurve& EI,
                      std::optional<double> tension_N) {
  model::Scene scene = campaign.scenes[*test.scene].scene;
  if (!tension_N) return scene;
  for (const auto& name : test.tension_of) model::set_parameter(scene, name, *tension_N);
  if (!EI.empty()) {
    for (const auto& name : test.EI_of) model::set_parameter(scene, name, EI.at(*tension_N));
  }
  return scene;
}

std::vector<ModalState> modal_states(const Campaign& campaign, const CampaignTest& test,
                                     const StiffnessCurve& EI) {
  const auto& results = *test.results;
  std::vector<ModalState> states;
  for (const auto& values : results.table.rows) {
    std::optional<double> tension;
    if (results.tension) tension = values[*results.tension];
    auto at = std::find_if(states.begin(), states.end(),
                           [&](const ModalState& state) { return state.tension_N == tension; });
    if (at == states.end()) {
      states.push_back({tension, std::nullopt, {}, {}, {}});
      at = states.end() - 1;
    }
    MeasuredRow row;
    row.measured_hz = values[*results.measured];
    for (const auto& [label, column] : results.models) row.models_hz.push_back(values[column]);
    at->rows.push_back(std::move(row));
  }
  std::sort(states.begin(), states.end(),
            [](const ModalState& a, const ModalState& b) { return a.tension_N < b.tension_N; });
  for (auto& state : states) {
    if (state.tension_N && !EI.empty() && !test.EI_of.empty()) {
      state.EI_Nm2 = EI.at(*state.tension_N);
    }
    double highest = 0;
    for (const auto& row : state.rows) {
      if (row.measured_hz > highest) highest = row.measured_hz;
    }
    model::ModesOptions options;
    // A third above the highest measured frequency: beyond that no pair would be accepted.
    options.band_hz = {{0.0, 1.35 * highest}};
    state.analysis = model::analyse_modes(scene_at(campaign, test, EI, state.tension_N), options);
    pair_rows(test, state);
  }
  return states;
}

RmsError rms_of_model(const std::vector<ModalState>& states) {
  double sum = 0;
  int rows = 0;
  for (const auto& state : states) {
    for (const auto& row : state.rows) {
      if (!row.mode) continue;
      const double error = state.analysis.modes[*row.mode].frequency_hz / row.measured_hz - 1;
      sum += error * error;
      ++rows;
    }
  }
  return rms(sum, rows);
}

RmsError rms_of_published(const std::vector<ModalState>& states, std::size_t model) {
  double sum = 0;
  int rows = 0;
  for (const auto& state : states) {
    for (const auto& row : state.rows) {
      const double error = row.models_hz[model] / row.measured_hz - 1;
      if (!std::isfinite(error)) continue;
      sum += error * error;
      ++rows;
    }
  }
  return rms(sum, rows);
}

}  // namespace rigfit::apps
