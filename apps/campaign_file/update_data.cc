#include "apps/campaign_file/update_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/campaign/campaign.h"
#include "apps/campaign_file/bending_files.h"
#include "apps/campaign_file/measured_modes.h"
#include "apps/campaign_file/recording_description.h"
#include "apps/cli/at_hand.h"
#include "apps/cli/exit_code.h"
#include "apps/cli/json_document.h"
#include "apps/cli/named_numbers.h"
#include "ident/campaign/single_tests/axial_campaign.h"
#include "ident/campaign/single_tests/scene_use.h"
#include "model/scene/scene.h"
#include "model/scene/scene_error.h"
#include "model/scene/sensor_quantity.h"
#include "signal/decay/decay.h"
#include "signal/modal/modal_identification.h"
#include "signal/readers/read_recording.h"
#include "signal/recording/units.h"

namespace rigfit::apps {
namespace {

class StateReader {
 public:
  StateReader(const UpdateData& data, VerbContext& context) : data_(data), context_(context) {
    files_ = data.modes.size() + data.frfs.size() + data.decays.size();
    if (data.scenes.size() > 1 && data.scenes.size() != files_) {
      throw UsageError(
          "with several scenes, give one --measured, --frf or --decay for each, in "
          "their order (tables, then FRFs, then decays)");
    }
    if (data.planes.size() > 1 && data.planes.size() != files_) {
      throw UsageError("--plane: one for all, or one for each file");
    }
    const std::size_t tests = files_ - data.modes.size();
    const auto universal = static_cast<std::size_t>(
        std::count_if(data.modes.begin(), data.modes.end(),
                      [](const auto& path) { return is_universal_file(path); }));
    modes_have_tensions_ = universal > 0 && data.tensions.size() == universal + tests;
    if (!data.tensions.empty() && data.tensions.size() != tests && !modes_have_tensions_) {
      throw UsageError(
          "--tension: one for each --frf and --decay, in their order; where --measured "
          "has universal files, one for each of them before these");
    }
    if (!data.stiffness.empty()) {
      result_.stiffness = read_stiffness_curve(data.stiffness, context);
      if (result_.stiffness.empty()) throw Refused(data.stiffness + " holds no EI over tension");
    }
    for (const auto& scene : data.scenes) several_ = several_ || scene != data.scenes.front();
  }

  UpdateStates read() {
    std::size_t file = 0;
    for (const auto& path : data_.modes) read_modes(path, file++);
    std::size_t& test = next_tension_;
    for (const auto& path : data_.frfs) read_frf(path, file++, tension_of(test++));
    for (const auto& path : data_.decays) read_decay(path, file++, tension_of(test++));
    const auto known = [](const auto& tension) { return tension.has_value(); };
    if (!result_.stiffness.empty() &&
        std::none_of(result_.tension.begin(), result_.tension.end(), known)) {
      throw UsageError("--stiffness goes by tension: give a tension_N column or --tension");
    }
    return std::move(result_);
  }

 private:
  std::optional<double> tension_of(std::size_t test) const {
    if (data_.tensions.empty()) return std::nullopt;
    return data_.tensions[test];
  }

  std::optional<model::ModePlane> plane_of(std::size_t file) const {
    if (data_.planes.empty()) return std::nullopt;
    return plane_named(data_.planes[data_.planes.size() == 1 ? 0 : file]);
  }

  const std::string& scene_of(std::size_t file) const {
    return data_.scenes[data_.scenes.size() > 1 ? file : 0];
  }

  // The state of that scene and tension; made when there is none yet.
  std::size_t state_at(const std::string& scene_file, const model::Scene& scene,
                       std::optional<double> tension) {
    for (std::size_t s = 0; s < result_.states.size(); ++s) {
      if (result_.scene_files[s] == scene_file && result_.tension[s] == tension) return s;
    }
    ident::UpdateState state;
    state.scene =
        tension ? cables_at(scene, *tension, result_.stiffness, data_.stiffness, context_) : scene;
    result_.segments.emplace_back();
    for (auto& member : state.scene.members) {
      result_.segments.back().push_back(member.segments);
      if (data_.segments > 0) member.segments = data_.segments;
    }
    if (several_) state.name = std::filesystem::path(scene_file).stem().string();
    if (tension) {
      state.name += fmt::format("{}{:g} N", state.name.empty() ? "" : ", ", *tension);
    }
    result_.states.push_back(std::move(state));
    result_.scene_files.push_back(scene_file);
    result_.tension.push_back(tension);
    return result_.states.size() - 1;
  }

  void add(std::size_t state, ident::MeasuredMode mode) {
    result_.states[state].measured.push_back(std::move(mode));
  }

  void add_clock(std::size_t state, double relative_std) {
    double& clock = result_.states[state].clock_relative_std;
    clock = std::max(clock, relative_std);
  }

  model::Scene scene_for(std::size_t file) { return apps::scene_of(scene_of(file), context_); }

  void read_modes(const std::string& path, std::size_t file) {
    const model::Scene scene = scene_for(file);
    const bool universal = is_universal_file(path);
    const auto stated =
        universal && modes_have_tensions_ ? tension_of(next_tension_++) : std::nullopt;
    std::size_t taken = 0;
    for (const auto& row : measured_modes(path, data_.column, plane_of(file), scene, context_)) {
      const double f = row.mode.frequency_hz.value;
      if (universal && !in_band(f)) continue;
      add(state_at(scene_of(file), scene, universal ? stated : row.tension_N), row.mode);
      ++taken;
    }
    if (taken == 0) throw UsageError(path + " has no mode within --band");
  }

  bool in_band(double f) const {
    return f >= data_.band_low_hz && (data_.band_high_hz == 0 || f <= data_.band_high_hz);
  }

  static double sign_of(int direction, const Eigen::Vector3d& along) {
    if (direction == 0) return 1;
    const double component = along[std::abs(direction) - 1] * (direction > 0 ? 1 : -1);
    return component < 0 ? -1 : 1;
  }

  void read_frf(const std::string& path, std::size_t file, std::optional<double> tension) {
    const model::Scene scene = scene_for(file);
    context_.input(path);
    signal::FrfSet set = signal::read_frfs({path});
    if (scene.loads.empty() || scene.sensors.empty()) {
      throw UsageError(scene_of(file) + " has no load or no sensor for the FRFs of " + path);
    }
    // Index and sign for each input, each response.
    std::vector<std::pair<std::size_t, double>> loads, sensors;
    for (const auto& input : set.inputs) {
      const std::size_t load = match(input.name, scene.loads, path, "load");
      loads.emplace_back(load, sign_of(input.direction, scene.loads[load].direction));
    }
    for (const auto& response : set.responses) {
      const std::size_t sensor = match(response.name, scene.sensors, path, "sensor");
      sensors.emplace_back(sensor, sign_of(response.direction, scene.sensors[sensor].direction));
    }
    const std::size_t at = state_at(scene_of(file), scene, tension);
    add_clock(at, set.sample_rate_relative_std);
    auto& state = result_.states[at];
    signal::ModalOptions options;
    options.low_hz = data_.band_low_hz, options.high_hz = data_.band_high_hz;
    const auto modal = [&] {
      try {
        return signal::identify_modes(set, options);
      } catch (const std::invalid_argument& error) {
        throw Refused(path + ": " + error.what());
      }
    }();
    for (const auto& found : modal.model.modes) {
      // A mode that is there leads, however little is known of its damping.
      if (found.doubtful && !(found.significance >= 4 && found.presence >= 0.6)) continue;
      ident::MeasuredMode mode;
      mode.frequency_hz = found.frequency_hz;
      if (found.doubtful) mode.damping_ratio.value = std::numeric_limits<double>::quiet_NaN();
      mode.plane = plane_of(file);
      if (set.responses.size() == scene.sensors.size() && set.responses.size() > 1) {
        mode.shape.resize(static_cast<Eigen::Index>(sensors.size()));
        for (std::size_t r = 0; r < sensors.size(); ++r) {
          mode.shape[static_cast<Eigen::Index>(sensors[r].first)] =
              sensors[r].second * found.shape[static_cast<Eigen::Index>(r)];
        }
      }
      add(at, std::move(mode));
    }
    state.modes_lead_only = true;
    for (std::size_t r = 0; r < sensors.size(); ++r) {
      const auto form = form_of(scene.sensors[sensors[r].first].quantity, path);
      const signal::FrfSet same = set.form == form ? set : signal::converted(set, form);
      std::vector<Eigen::Index> lines;
      for (Eigen::Index k = 0; k < same.frequency_hz.size(); ++k) {
        if (same.frequency_hz[k] > 0 && in_band(same.frequency_hz[k])) lines.push_back(k);
      }
      for (std::size_t i = 0; i < loads.size(); ++i) {
        const auto column = same.column(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(i));
        ident::MeasuredFrf frf;
        frf.sensor = sensors[r].first;
        frf.load = loads[i].first;
        frf.frequency_hz = same.frequency_hz(lines);
        frf.H = sensors[r].second * loads[i].second * same.H(lines, column);
        if (same.H_std.size() > 0) frf.std = same.H_std(lines, column);
        frf.decay_rate_1_s = set.exponential_decay_rate_1_s;
        if (set.frequency_hz.size() > 1) {
          frf.lines_per_independent = ident::lines_per_independent(
              frf.decay_rate_1_s, set.frequency_hz[1] - set.frequency_hz[0]);
        }
        state.frfs.push_back(std::move(frf));
      }
    }
  }

  template <typename Named>
  std::size_t match(const std::string& name, const std::vector<Named>& named,
                    const std::string& path, const char* what) const {
    for (std::size_t i = 0; i < named.size(); ++i) {
      if (named[i].name == name) return i;
    }
    if (named.size() == 1) return 0;
    std::string known;
    for (const auto& one : named) known += (known.empty() ? "" : ", ") + one.name;
    throw UsageError(
        fmt::format("{}: \"{}\" is no {} of the scene; there are: {}", path, name, what, known));
  }

  static signal::FrfForm form_of(model::Sensor::Quantity quantity, const std::string& path) {
    const auto unit = signal::parse_unit(model::described(quantity).unit);
    const auto form = signal::form_of(unit ? unit->quantity : signal::Quantity::unknown);
    if (form != signal::FrfForm::unknown) return form;
    throw UsageError(path + ": FRFs of force sensors are not fitted");
  }

  void read_decay(const std::string& path, std::size_t file, std::optional<double> tension) {
    const model::Scene scene = scene_for(file);
    const auto recording = load_recording(path, context_);
    const auto& channel = chosen_channel(recording, data_.decay_channel);
    signal::DecayOptions options;
    options.band_low_hz = data_.band_low_hz, options.band_high_hz = data_.band_high_hz;
    const auto decay = signal::estimate_decay(channel.samples, recording.sample_rate_hz, options);
    if (!decay.refusal.empty()) throw Refused(path + ": " + decay.refusal);
    const std::size_t at = state_at(scene_of(file), scene, tension);
    add_clock(at, recording.sample_rate_relative_std);
    for (const auto& found : decay.modes) {
      if (found.doubtful) {
        context_.warn("doubtful", found.doubt, path);
        continue;
      }
      ident::MeasuredMode mode;
      mode.frequency_hz = found.frequency_hz;
      mode.damping_ratio = found.damping_ratio;
      mode.plane = plane_of(file);
      add(at, std::move(mode));
    }
  }

  const UpdateData& data_;
  VerbContext& context_;
  std::size_t files_ = 0;
  std::size_t next_tension_ = 0;      ///< next of data_.tensions
  bool modes_have_tensions_ = false;  ///< those of universal files, before the others
  bool several_ = false;              // scenes
  UpdateStates result_;
};

}  // namespace

UpdateStates read_update_states(const UpdateData& data, VerbContext& context) {
  return StateReader(data, context).read();
}

namespace {

using Effect = ident::UncertainInput::Effect;

struct InputText {
  std::string name;
  SignedNames targets;
  double std = 0;
  bool relative = false, each = false;
};

InputText parsed(std::string text) {
  InputText input;
  input.each = text.ends_with("@each");
  if (input.each) text.resize(text.size() - 5);
  const auto given =
      named_numbers("--input", text,
                    "TARGET=STD, TARGET=0.5% or TARGET,-TARGET=STD (@each at the end)", 1, 1, true);
  input.name = given.name;
  input.targets = signed_names("--input", given.name);
  input.std = given.numbers[0], input.relative = given.relative;
  return input;
}

bool has_parameter(const model::Scene& scene, const std::string& name) {
  const auto names = model::parameter_names(scene);
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Known values as inputs that move the cables of all states together.
std::vector<ident::UncertainInput> known_inputs(const ident::KnownValues& known,
                                                const UpdateStates& states) {
  std::vector<ident::SceneUse> uses;
  for (const auto& state : states.states) uses.push_back(use_of_cables(state.scene));
  std::vector<ident::StateUse> of_states;
  for (std::size_t s = 0; s < uses.size(); ++s) {
    of_states.push_back({static_cast<int>(s), &uses[s], states.tension[s]});
  }
  return ident::known_inputs(known, of_states);
}

// The effects of a state's tension being off by `std`.
void add_tension(const UpdateStates& states, std::size_t state, double std, bool relative,
                 std::vector<Effect>& effects) {
  const auto& tension = states.tension[state];
  for (const auto& member : states.states[state].scene.members) {
    if (member.kind != model::Member::Kind::cable || !member.tension) continue;
    const double change = relative ? std * *member.tension : std;
    effects.push_back({static_cast<int>(state), member.name + ".tension", change});
    if (states.stiffness.empty() || !tension) continue;
    const double slope = states.stiffness.at(*tension).slope_m2;
    effects.push_back({static_cast<int>(state), member.name + ".EI", slope * change});
  }
}

void add_targets(const InputText& input, const UpdateStates& states, std::size_t state,
                 std::vector<Effect>& effects) {
  const auto& scene = states.states[state].scene;
  if (input.targets.names[0] == "tension") {
    add_tension(states, state, input.std, input.relative, effects);
    return;
  }
  for (std::size_t t = 0; t < input.targets.names.size(); ++t) {
    if (!has_parameter(scene, input.targets.names[t])) continue;
    const double size =
        input.relative ? std::abs(model::parameter(scene, input.targets.names[t])) : 1;
    effects.push_back({static_cast<int>(state), input.targets.names[t],
                       input.targets.signs[t] * input.std * size});
  }
}

}  // namespace

std::vector<ident::UncertainInput> uncertain_inputs(const std::vector<std::string>& texts,
                                                    const UpdateStates& states) {
  std::vector<ident::UncertainInput> inputs;
  for (const auto& text : texts) {
    const InputText input = parsed(text);
    for (const auto& target : input.targets.names) {
      if (target == "tension") continue;
      bool somewhere = false;
      for (const auto& state : states.states) {
        somewhere = somewhere || has_parameter(state.scene, target);
      }
      // Says which parameters there are.
      if (!somewhere) (void)model::parameter(states.states.front().scene, target);
    }
    ident::UncertainInput all{input.name, {}};
    for (std::size_t s = 0; s < states.states.size(); ++s) {
      if (!input.each) {
        add_targets(input, states, s, all.effects);
        continue;
      }
      ident::UncertainInput one{fmt::format("{} [{}]", input.name, states.states[s].name), {}};
      add_targets(input, states, s, one.effects);
      if (!one.effects.empty()) inputs.push_back(std::move(one));
    }
    if (!all.effects.empty()) inputs.push_back(std::move(all));
  }
  if (states.stiffness.empty()) return inputs;
  for (auto& input : known_inputs({states.stiffness, {}}, states)) {
    inputs.push_back(std::move(input));
  }
  return inputs;
}

std::vector<ident::UncertainInput> axial_inputs(const std::string& path, UpdateStates& states) {
  constexpr const char* kBy = "rigfit axial ... --json FILE";
  const Json document = read_document(path, "EA_N", kBy);
  const Json value = document.value("EA_N", Json());
  const signal::Estimate EA_N{number_in(value, "value"), number_in(value, "std")};
  if (!(EA_N.value > 0) || !(EA_N.std > 0)) {
    throw model::SceneError({path, 0, 0, "EA_N"}, "has no std: it cannot be weighed",
                            "give --length-std and --mass-std to rigfit axial");
  }
  const ident::KnownValues known{{}, ident::AxialKnowledge{EA_N, {}}};
  for (auto& state : states.states) {
    state.scene = ident::scene_at(use_of_cables(state.scene), known, {}).scene;
  }
  return known_inputs(known, states);
}

ident::FreeParameter free_parameter(std::string text) {
  ident::FreeParameter parameter;
  if (text.ends_with("@each")) {
    parameter.per_state = true;
    text.resize(text.size() - 5);
  }
  const auto equals = text.find('=');
  parameter.name = text.substr(0, equals);
  if (equals != std::string::npos) {
    auto targets = signed_names("--free", text.substr(equals + 1));
    parameter.targets = std::move(targets.names);
    parameter.factors = std::move(targets.signs);
  }
  if (parameter.name.empty()) throw UsageError("--free: a parameter without a name");
  return parameter;
}

std::vector<ident::FreeParameter> free_parameters(const std::vector<std::string>& free_texts,
                                                  const std::vector<std::string>& priors,
                                                  const model::Scene& scene) {
  std::vector<ident::FreeParameter> free;
  free.reserve(free_texts.size());
  for (const auto& text : free_texts) free.push_back(free_parameter(text));
  if (free.empty()) {
    for (const auto& member : scene.members) {
      const std::string name = member.name + (member.EI[0] == member.EI[1] ? ".EI" : ".EI_z");
      free.push_back(free_parameter(name));
    }
  }
  for (const auto& text : priors) {
    const auto prior = named_numbers("--prior", text, "NAME=VALUE,STD", 2, 2);
    auto known = std::find_if(free.begin(), free.end(),
                              [&](const auto& parameter) { return parameter.name == prior.name; });
    if (known == free.end()) throw UsageError("--prior: " + prior.name + " is not among --free");
    known->prior = signal::Estimate{prior.numbers[0], prior.numbers[1]};
  }
  return free;
}

}  // namespace rigfit::apps
