#include "ident/campaign/modal/modal_model.h"

#include <fmt/format.h>

#include <type_traits>

#include "ident/update/pairing/mode_assignment.h"
#include "model/scene/parameters.h"
#include "signal/estimation/robust.h"

namespace rigfit::ident {
namespace {

void add_recorded(std::vector<ModalState>& states, const ModalTestState& recorded,
                  std::size_t published_models) {
  ModalState& state = states.emplace_back();
  state.tension_N = recorded.tension_N;
  state.recorded = &recorded;
  for (const auto& mode : recorded.modal->model.modes) {
    MeasuredRow row;
    row.frequency_hz = mode.frequency_hz;
    if (!mode.damping_dominated_by_window) row.damping_ratio = mode.damping_ratio;
    row.origin = recorded.origin;
    row.shape = mode.shape;
    row.models_hz.assign(published_models, kNaN);
    state.rows.push_back(std::move(row));
  }
}

void add_published(std::vector<ModalState>& states, const PublishedMode& published) {
  MeasuredRow row;
  row.frequency_hz.value = published.measured_hz;
  row.models_hz = published.models_hz;
  std::vector<std::optional<double>> tensions(states.size());
  std::ranges::transform(states, tensions.begin(), &ModalState::tension_N);
  const auto state = state_at(tensions, published.tension_N);
  if (!state) states.emplace_back().tension_N = published.tension_N;
  states[state.value_or(tensions.size())].rows.push_back(std::move(row));
}

double typical_segments_error(const model::ModalAnalysis& analysis) {
  std::vector<double> errors;
  for (const auto& mode : analysis.modes) {
    const double error = std::abs(mode.extrapolated_hz / mode.frequency_hz - 1);
    if (std::isfinite(error)) errors.push_back(error);
  }
  return signal::median(errors);
}

/// Pairs rows with modes of an analysis of the instrumented scene.
void pair_rows(const model::ModalAnalysis& analysis, std::vector<MeasuredRow>& rows) {
  // Recorded and published rows are two tests: the same mode may be seen by both.
  std::set<Origin> origins;
  for (const auto& row : rows) origins.insert(row.origin);
  std::vector<PairingMode> modelled;
  for (const auto& mode : analysis.modes) {
    if (!(mode.frequency_hz > 0)) continue;
    modelled.push_back(
        {mode.frequency_hz, mode.plane, mode.sensor_shape.cast<std::complex<double>>(), 1});
  }
  const auto first = analysis.modes.size() - modelled.size();  // rigid motions come first
  for (const Origin origin : origins) {
    std::vector<PairingMode> measured;
    std::vector<std::size_t> row_of;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto& row = rows[i];
      if (row.origin != origin || !std::isfinite(row.frequency_hz.value)) continue;
      measured.push_back({row.frequency_hz.value, row.plane, row.shape, 1});
      row_of.push_back(i);
    }
    if (measured.empty() || modelled.empty()) continue;
    for (const auto& pair : pair_modes(measured, modelled)) {
      auto& row = rows[row_of[static_cast<std::size_t>(pair.measured)]];
      row.mode = first + static_cast<std::size_t>(pair.model);
      row.mac = pair.mac;
      row.other_plane = pair.cross_plane;
    }
  }
}

}  // namespace

model::Scene scene_at(const SceneUse& use, const KnownValues& known,
                      std::optional<double> tension_N) {
  model::Scene scene = use.scene;
  const auto set = [&](const std::vector<std::string>& names, double value) {
    for (const auto& name : names) {
      if (std::isfinite(value)) model::set_parameter(scene, name, value);
    }
  };
  set(use.EA_of, known.EA_N.value);
  set(use.damping_of, known.damping_ratio.value);
  if (!tension_N) return scene;
  set(use.tension_of, *tension_N);
  if (!known.EI.empty()) set(use.EI_of, known.EI.at(*tension_N).EI_Nm2);
  return scene;
}

std::vector<UncertainInput> known_inputs(const KnownValues& known,
                                         const std::vector<StateUse>& states) {
  std::vector<UncertainInput> inputs;
  /// `std_in`: standard uncertainty of the value in a state.
  const auto add = [&](std::string name, std::vector<std::string> SceneUse::*names, auto std_in) {
    UncertainInput input{std::move(name), {}};
    for (std::size_t s = 0; s < states.size(); ++s) {
      const double change = std_in(s);
      if (!std::isfinite(change) || change == 0) continue;
      for (const auto& target : states[s].use.*names) {
        input.effects.push_back({static_cast<int>(s), target, change});
      }
    }
    if (!input.effects.empty()) inputs.push_back(std::move(input));
  };
  std::vector<double> tensions;
  tensions.reserve(states.size());
  for (const auto& one : states) tensions.push_back(one.tension_N.value_or(1));
  for (const auto& term : known.EI.uncertainty(tensions)) {
    add(term.name, &SceneUse::EI_of, [&](std::size_t s) {
      return states[s].tension_N ? term.change_Nm2[static_cast<Index>(s)] : 0;
    });
  }
  add("EA (axial test)", &SceneUse::EA_of, [&](auto) { return known.EA_N.std; });
  add("damping ratio (axial test)", &SceneUse::damping_of,
      [&](auto) { return known.damping_ratio.std; });
  return inputs;
}

Instrumented instrumented(model::Scene scene, const ModalInputs& test,
                          const ModalTestState& recorded) {
  Instrumented rig;
  const auto form = recorded.hammer.frfs.form;
  const auto quantity = form == signal::FrfForm::receptance ? model::Sensor::Quantity::displacement
                        : form == signal::FrfForm::mobility ? model::Sensor::Quantity::velocity
                                                            : model::Sensor::Quantity::acceleration;
  const auto oriented = [&](Vector3d& direction, const Vector3d& recorded_direction) {
    if (recorded_direction.norm() > 0.5) direction = recorded_direction.normalized();
    // A test said to go along one direction: as the scene's, it is struck and measured there.
    if (test.direction) {
      const double sign = direction.dot(*test.direction) < 0 ? -1 : 1;
      direction = sign * *test.direction;
    }
  };
  // The scene's `all` of these names, in their order, and the index of each name.
  const auto taken = [&](auto& all, const auto& names, const auto& directions, auto& indices) {
    std::vector<std::decay_t<decltype(all[0])>> kept;
    for (std::size_t i = 0; i < names.size(); ++i) {
      for (const auto& one : all) {
        if (one.name != names[i]) continue;
        kept.push_back(one);
        oriented(kept.back().direction, directions[i]);
        indices.push_back(static_cast<Index>(i));
      }
    }
    all = std::move(kept);
  };
  auto sensors = recorded.channels;
  for (auto& name : sensors) {
    const auto other = test.sensors.find(name);
    if (other != test.sensors.end()) name = other->second;
  }
  std::vector<std::string> loads;
  for (const auto& input : recorded.hammer.frfs.inputs) loads.push_back(input.name);
  taken(scene.sensors, sensors, recorded.directions, rig.response);
  taken(scene.loads, loads, recorded.force_directions, rig.input);
  for (auto& sensor : scene.sensors) sensor.quantity = quantity;
  rig.scene = std::move(scene);
  return rig;
}

std::optional<std::size_t> state_at(const std::vector<std::optional<double>>& tensions,
                                    std::optional<double> tension_N) {
  std::optional<std::size_t> nearest;
  double least = 0.005 * tension_N.value_or(0);
  for (std::size_t s = 0; s < tensions.size(); ++s) {
    if (tensions[s].has_value() != tension_N.has_value()) continue;
    const double apart = std::abs(tensions[s].value_or(0) - tension_N.value_or(0));
    if (apart <= least) least = apart, nearest = s;
  }
  return nearest;
}

std::string state_label(std::optional<double> tension_N) {
  return tension_N ? fmt::format("{:g} N", *tension_N) : std::string("as built");
}

std::vector<ModalState> modal_states(const ModalInputs& test, const KnownValues& known,
                                     const std::vector<ModalTestState>& recorded) {
  std::vector<ModalState> states;
  const SceneUse& use = *test.scene;
  const std::size_t models = test.published.empty() ? 0 : test.published.front().models_hz.size();
  for (const auto& one : recorded) {
    if (one.has_modes()) add_recorded(states, one, models);
  }
  for (const auto& one : test.published) add_published(states, one);
  std::ranges::sort(states, {}, &ModalState::tension_N);
  for (auto& state : states) {
    state.rig.scene = scene_at(use, known, state.tension_N);
    if (state.tension_N && !known.EI.empty() && !use.EI_of.empty()) {
      state.EI_Nm2 = known.EI.at(*state.tension_N).EI_Nm2;
    }
    if (state.recorded) {
      state.rig = instrumented(std::move(state.rig.scene), test, *state.recorded);
    }
    double highest = 0;
    for (auto& row : state.rows) {
      row.plane = test.plane;
      if (row.shape.size() > 0) row.shape = row.shape(state.rig.response).eval();
      if (row.frequency_hz.value > highest) highest = row.frequency_hz.value;
    }
    model::ModesOptions options;
    // A third above the highest measured frequency: beyond that no pair would be accepted.
    options.band_hz = {{0.0, 1.35 * highest}};
    state.analysis = model::analyse_modes(state.rig.scene, options);
    state.segments_error = typical_segments_error(state.analysis);
    pair_rows(state.analysis, state.rows);
  }
  return states;
}

RmsError rms_error(const std::vector<ModalState>& states, std::optional<std::size_t> published) {
  RmsError rms{0, 0};
  for (const auto& state : states) {
    for (const auto& row : state.rows) {
      const bool own = !state.recorded || row.origin == state.recorded->origin;
      double hz = kNaN;
      if (published && row.models_hz.size() > *published) hz = row.models_hz[*published];
      if (!published && row.mode && own) hz = state.analysis.modes[*row.mode].frequency_hz;
      const double error = hz / row.frequency_hz.value - 1;
      if (std::isfinite(error)) rms.value += error * error, ++rms.rows;
    }
  }
  rms.value = std::sqrt(rms.value / rms.rows);
  return rms;
}

}  // namespace rigfit::ident
