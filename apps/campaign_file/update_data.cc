#include "apps/campaign_file/update_data.h"

#include "apps/campaign/campaign.h"
#include "apps/campaign_file/bending_files.h"
#include "apps/campaign_file/measured_modes.h"
#include "apps/campaign_file/recordings.h"
#include "apps/results/results_json.h"
#include "ident/campaign/modal/modal_model.h"
#include "ident/campaign/single_tests/axial_campaign.h"
#include "model/scene/scene.h"
#include "model/scene/sensor_quantity.h"
#include "signal/decay/decay.h"
#include "signal/modal/modal_identification.h"
#include "signal/readers/read_recording.h"
#include "signal/recording/units.h"

namespace rigfit::apps {
namespace {

/// A file of data, with what is said of it.
struct Source {
  std::string path, scene;
  std::optional<model::ModePlane> plane;
  std::optional<double> tension;
};

class StateReader {
 public:
  StateReader(const UpdateData& data, VerbContext& context) : data_(data), context_(context) {
    if (!data.stiffness.empty()) {
      result_.stiffness = read_stiffness_curve(data.stiffness, context);
      if (result_.stiffness.empty()) throw Refused(data.stiffness + " holds no EI over tension");
    }
    several_ = std::ranges::count(data.scenes, data.scenes.front()) <
               static_cast<std::ptrdiff_t>(data.scenes.size());
  }

  UpdateStates read() {
    const std::size_t tests = data_.frfs.size() + data_.decays.size();
    const std::size_t files = data_.modes.size() + tests;
    const auto universal =
        static_cast<std::size_t>(std::ranges::count_if(data_.modes, is_universal_file));
    if (data_.scenes.size() > 1 && data_.scenes.size() != files) {
      throw UsageError(
          "with several scenes, give one --measured, --frf or --decay for each, in "
          "their order (tables, then FRFs, then decays)");
    }
    if (data_.planes.size() > 1 && data_.planes.size() != files) {
      throw UsageError("--plane: one for all, or one for each file");
    }
    const std::size_t tensions = data_.tensions.size();
    const bool of_modes = universal > 0 && tensions == universal + tests;
    if (tensions > 0 && tensions != tests && !of_modes) {
      throw UsageError(
          "--tension: one for each --frf and --decay, in their order; where --measured "
          "has universal files, one for each of them before these");
    }
    for (const auto& path : data_.modes)
      read_modes(next(path, of_modes && is_universal_file(path)));
    for (const auto& path : data_.frfs) read_frf(next(path, tensions > 0));
    for (const auto& path : data_.decays) read_decay(next(path, tensions > 0));
    if (!result_.stiffness.empty() &&
        std::ranges::none_of(result_.tension, [](const auto& one) { return one.has_value(); })) {
      throw UsageError("--stiffness goes by tension: give a tension_N column or --tension");
    }
    return std::move(result_);
  }

 private:
  /// The next file, in the order of scenes and planes, and of tensions where it has one.
  Source next(const std::string& path, bool has_tension) {
    const std::size_t file = next_file_++;
    Source one{path, data_.scenes[data_.scenes.size() > 1 ? file : 0], {}, {}};
    if (!data_.planes.empty())
      one.plane = plane_named(data_.planes[data_.planes.size() > 1 ? file : 0]);
    if (has_tension) one.tension = data_.tensions[next_tension_++];
    return one;
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

  /// The state of a source whose times are known to that.
  ident::UpdateState& timed_state(const Source& source, const model::Scene& scene,
                                  double clock_relative_std) {
    auto& state = result_.states[state_at(source.scene, scene, source.tension)];
    state.clock_relative_std = std::max(state.clock_relative_std, clock_relative_std);
    return state;
  }

  void read_modes(const Source& source) {
    const model::Scene scene = scene_of(source.scene, context_);
    const bool universal = is_universal_file(source.path);
    auto rows = measured_modes(source.path, data_.column, source.plane, scene, context_);
    if (universal) {
      std::erase_if(rows, [&](const auto& row) { return !in_band(row.frequency_hz.value); });
    }
    if (rows.empty()) throw UsageError(source.path + " has no mode within --band");
    for (auto& row : rows) {
      const auto state = state_at(source.scene, scene, universal ? source.tension : row.tension_N);
      result_.states[state].measured.push_back(std::move(row));
    }
  }

  bool in_band(double f) const {
    return f >= data_.band_low_hz && (data_.band_high_hz == 0 || f <= data_.band_high_hz);
  }

  static double sign_of(int direction, const Eigen::Vector3d& along) {
    if (direction == 0) return 1;
    const double component = along[std::abs(direction) - 1] * (direction > 0 ? 1 : -1);
    return component < 0 ? -1 : 1;
  }

  void read_frf(const Source& source) {
    const auto& path = source.path;
    const model::Scene scene = scene_of(source.scene, context_);
    context_.input(path);
    signal::FrfSet set = signal::read_frfs({path});
    if (scene.loads.empty() || scene.sensors.empty()) {
      throw UsageError(source.scene + " has no load or no sensor for the FRFs of " + path);
    }
    // Index and sign for each input, each response.
    std::vector<std::pair<std::size_t, double>> loads, sensors;
    for (const auto& input : set.inputs) {
      const std::size_t load = match(input.name, set.inputs.size(), scene.loads, path, "load");
      loads.emplace_back(load, sign_of(input.direction, scene.loads[load].direction));
    }
    for (const auto& response : set.responses) {
      const std::size_t sensor =
          match(response.name, set.responses.size(), scene.sensors, path, "sensor");
      sensors.emplace_back(sensor, sign_of(response.direction, scene.sensors[sensor].direction));
    }
    auto& state = timed_state(source, scene, set.sample_rate_relative_std);
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
      mode.plane = source.plane;
      if (set.responses.size() == scene.sensors.size() && set.responses.size() > 1) {
        mode.shape.resize(static_cast<Eigen::Index>(sensors.size()));
        for (std::size_t r = 0; r < sensors.size(); ++r) {
          mode.shape[static_cast<Eigen::Index>(sensors[r].first)] =
              sensors[r].second * found.shape[static_cast<Eigen::Index>(r)];
        }
      }
      state.measured.push_back(std::move(mode));
    }
    state.modes_lead_only = true;
    for (std::size_t r = 0; r < sensors.size(); ++r) {
      const auto& quantity = model::described(scene.sensors[sensors[r].first].quantity);
      const auto form = signal::form_of(signal::parse_unit(quantity.unit)->quantity);
      if (form == signal::FrfForm::unknown) {
        throw UsageError(path + ": FRFs of force sensors are not fitted");
      }
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
  std::size_t match(const std::string& name, std::size_t names, const std::vector<Named>& named,
                    const std::string& path, const char* what) const {
    const auto at = std::ranges::find(named, name, &Named::name);
    if (at != named.end()) return static_cast<std::size_t>(at - named.begin());
    if (names == 1 && named.size() == 1) return 0;
    std::vector<std::string> known;
    std::ranges::transform(named, std::back_inserter(known), &Named::name);
    throw UsageError(
        fmt::format("{}: \"{}\" is no {} of the scene, which has {}: give it that "
                    "name in the scene",
                    path, name, what, fmt::join(known, ", ")));
  }

  void read_decay(const Source& source) {
    const auto& path = source.path;
    const model::Scene scene = scene_of(source.scene, context_);
    const auto recording = load_recording(path, context_);
    const auto& channel = chosen_channel(recording, data_.decay_channel);
    signal::DecayOptions options;
    options.band_low_hz = data_.band_low_hz, options.band_high_hz = data_.band_high_hz;
    const auto decay = signal::estimate_decay(channel.samples, recording.sample_rate_hz, options);
    if (!decay.refusal.empty()) throw Refused(path + ": " + decay.refusal);
    for (const auto& note : decay.notes) context_.warn(note.code, note.message, path);
    auto& state = timed_state(source, scene, recording.sample_rate_relative_std);
    for (const auto& found : decay.modes) {
      auto& mode = state.measured.emplace_back();
      mode.frequency_hz = found.frequency_hz;
      mode.damping_ratio = found.damping_ratio;
      mode.plane = source.plane;
    }
  }

  const UpdateData& data_;
  VerbContext& context_;
  std::size_t next_file_ = 0, next_tension_ = 0;
  bool several_ = false;  ///< scenes
  UpdateStates result_;
};

using Effect = ident::UncertainInput::Effect;

bool has_parameter(const model::Scene& scene, const std::string& name) {
  const auto names = model::parameter_names(scene);
  return std::ranges::find(names, name) != names.end();
}

/// Known values as inputs that move the cables of all states together.
std::vector<ident::UncertainInput> known_inputs(const ident::KnownValues& known,
                                                const UpdateStates& states) {
  std::vector<ident::StateUse> uses;
  for (std::size_t s = 0; s < states.states.size(); ++s) {
    uses.push_back({use_of_cables(states.states[s].scene), states.tension[s]});
  }
  return ident::known_inputs(known, uses);
}

/// What an input changes in a state.
void add_effects(const SignedNames& targets, const NamedNumbers& input, const UpdateStates& states,
                 std::size_t state, std::vector<Effect>& effects) {
  const auto& scene = states.states[state].scene;
  const int index = static_cast<int>(state);
  const double std = input.numbers[0];
  if (targets.names[0] == "tension") {
    const auto& tension = states.tension[state];
    for (const auto& member : scene.members) {
      if (member.kind != model::Member::Kind::cable || !member.tension) continue;
      const double change = std * (input.relative ? *member.tension : 1);
      effects.push_back({index, member.name + ".tension", change});
      if (states.stiffness.empty() || !tension) continue;
      const double slope = states.stiffness.at(*tension).slope_m2;
      effects.push_back({index, member.name + ".EI", slope * change});
    }
    return;
  }
  for (std::size_t t = 0; t < targets.names.size(); ++t) {
    const auto& name = targets.names[t];
    if (!has_parameter(scene, name)) continue;
    const double size = input.relative ? std::abs(model::parameter(scene, name)) : 1;
    effects.push_back({index, name, targets.signs[t] * std * size});
  }
}

}  // namespace

UpdateStates read_update_states(const UpdateData& data, VerbContext& context) {
  return StateReader(data, context).read();
}

std::vector<ident::UncertainInput> uncertain_inputs(const std::vector<std::string>& texts,
                                                    const UpdateStates& states) {
  std::vector<ident::UncertainInput> inputs;
  for (std::string text : texts) {
    const bool each = text.ends_with("@each");
    if (each) text.resize(text.size() - 5);
    const auto input = named_numbers(
        "--input", text, "TARGET=STD, TARGET=0.5% or TARGET,-TARGET=STD (@each at the end)", 1, 1,
        true);
    const auto targets = signed_names("--input", input.name);
    for (const auto& target : targets.names) {
      const bool somewhere =
          target == "tension" || std::ranges::any_of(states.states, [&](const auto& state) {
            return has_parameter(state.scene, target);
          });
      // Says which parameters there are.
      if (!somewhere) (void)model::parameter(states.states.front().scene, target);
    }
    for (std::size_t s = 0; s < states.states.size(); ++s) {
      if (each) {
        inputs.push_back({fmt::format("{} [{}]", input.name, states.states[s].name), {}});
      } else if (s == 0) {
        inputs.push_back({input.name, {}});
      }
      add_effects(targets, input, states, s, inputs.back().effects);
    }
  }
  std::erase_if(inputs, [](const auto& one) { return one.effects.empty(); });
  if (!states.stiffness.empty()) {
    std::ranges::move(known_inputs({states.stiffness, {}, {}}, states), std::back_inserter(inputs));
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
  const ident::KnownValues known{{}, EA_N, {}};
  for (auto& state : states.states) {
    state.scene = ident::scene_at(use_of_cables(state.scene), known, {});
  }
  return known_inputs(known, states);
}

ident::FreeParameter free_parameter(std::string text) {
  ident::FreeParameter parameter;
  parameter.per_state = text.ends_with("@each");
  if (parameter.per_state) text.resize(text.size() - 5);
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
    const auto known = std::ranges::find(free, prior.name, &ident::FreeParameter::name);
    if (known == free.end()) throw UsageError("--prior: " + prior.name + " is not among --free");
    known->prior = signal::Estimate{prior.numbers[0], prior.numbers[1]};
  }
  return free;
}

}  // namespace rigfit::apps
