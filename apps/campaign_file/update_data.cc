#include "apps/campaign_file/update_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/campaign/campaign.h"
#include "apps/campaign_file/bending_files.h"
#include "apps/campaign_file/measured_modes.h"
#include "apps/campaign_file/recording_description.h"
#include "apps/cli/exit_code.h"
#include "model/scene/read_scene.h"
#include "signal/decay/decay.h"
#include "signal/modal/modal_identification.h"
#include "signal/readers/uff/read_uff.h"

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
      context.input(data.stiffness);
      result_.stiffness = read_stiffness_curve(data.stiffness);
      if (result_.stiffness.empty()) throw Refused(data.stiffness + " holds no EI over tension");
    }
    for (const auto& scene : data.scenes) several_ = several_ || scene != data.scenes.front();
  }

  UpdateStates read() {
    std::size_t file = 0;
    for (const auto& path : data_.modes) read_table(path, file++);
    std::size_t& test = next_tension_;
    for (const auto& path : data_.frfs) read_frf(path, file++, tension_of(test++));
    for (const auto& path : data_.decays) read_decay(path, file++, tension_of(test++));
    check_compared();
    const auto known = [](const auto& tension) { return tension.has_value(); };
    if (!result_.stiffness.empty() &&
        std::none_of(result_.tension.begin(), result_.tension.end(), known)) {
      throw UsageError("--stiffness goes by tension: give a tension_N column or --tension");
    }
    return std::move(result_);
  }

 private:
  void check_compared() const {
    for (std::size_t c = 0; c < data_.compare.size(); ++c) {
      bool somewhere = false;
      for (const auto& rows : result_.compared) {
        for (const auto& row : rows) somewhere = somewhere || std::isfinite(row[c]);
      }
      if (!somewhere) {
        throw UsageError("--compare: no table has a number in a column \"" + data_.compare[c] +
                         "\"");
      }
    }
  }

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
    state.scene = scene;
    result_.segments.emplace_back();
    for (auto& member : state.scene.members) {
      result_.segments.back().push_back(member.segments);
      if (data_.segments > 0) member.segments = data_.segments;
    }
    if (several_) state.name = std::filesystem::path(scene_file).stem().string();
    if (tension) {
      state.name += fmt::format("{}{:g} N", state.name.empty() ? "" : ", ", *tension);
      for (const auto& member : scene.members) {
        if (member.kind != model::Member::Kind::cable) continue;
        model::set_parameter(state.scene, member.name + ".tension", *tension);
        if (result_.stiffness.empty()) continue;
        model::set_parameter(state.scene, member.name + ".EI",
                             stiffness_at(result_.stiffness, *tension, data_.stiffness, context_));
      }
    }
    result_.states.push_back(std::move(state));
    result_.scene_files.push_back(scene_file);
    result_.tension.push_back(tension);
    result_.compared.emplace_back();
    return result_.states.size() - 1;
  }

  void add(std::size_t state, ident::MeasuredMode mode, std::vector<double> compared) {
    result_.states[state].measured.push_back(std::move(mode));
    compared.resize(data_.compare.size(), std::numeric_limits<double>::quiet_NaN());
    result_.compared[state].push_back(std::move(compared));
  }

  void add_clock(std::size_t state, double rate_hz, double relative_std) {
    if (relative_std > 0) {
      result_.clocks.push_back({static_cast<int>(state), rate_hz, relative_std});
    }
  }

  model::Scene scene_for(std::size_t file) {
    context_.input(scene_of(file));
    return model::read_scene(scene_of(file));
  }

  void read_table(const std::string& path, std::size_t file) {
    const model::Scene scene = scene_for(file);
    context_.input(path);
    if (is_universal_file(path)) {
      read_uff_modes(path, file, scene);
      return;
    }
    std::vector<std::string> sensors;
    for (const auto& sensor : scene.sensors) sensors.push_back(sensor.name);
    for (const auto& row :
         read_measured_modes(path, data_.column, plane_of(file), sensors, data_.compare)) {
      add(state_at(scene_of(file), scene, row.tension_N), row.mode, row.compared);
    }
  }

  void read_uff_modes(const std::string& path, std::size_t file, const model::Scene& scene) {
    if (!data_.column.empty() || !data_.compare.empty()) {
      throw UsageError(path + " is a universal file: --column and --compare are of tables");
    }
    std::vector<std::string> remarks;
    const auto rows = read_uff_measured_modes(path, plane_of(file), scene, remarks);
    for (const auto& remark : remarks) context_.warn("universal_file", remark, path);
    const std::size_t before = taken_;
    const auto tension = modes_have_tensions_ ? tension_of(next_tension_++) : std::nullopt;
    for (const auto& row : rows) {
      const double f = row.mode.frequency_hz.value;
      if (data_.band_hz && (f < data_.band_hz->first || f > data_.band_hz->second)) continue;
      add(state_at(scene_of(file), scene, tension), row.mode, {});
      ++taken_;
    }
    if (taken_ == before) throw UsageError(path + " has no mode within --band");
  }

  static double sign_of(int direction, const Eigen::Vector3d& along) {
    if (direction == 0) return 1;
    const double component = along[std::abs(direction) - 1] * (direction > 0 ? 1 : -1);
    return component < 0 ? -1 : 1;
  }

  void read_frf(const std::string& path, std::size_t file, std::optional<double> tension) {
    const model::Scene scene = scene_for(file);
    context_.input(path);
    signal::FrfSet set = signal::read_uff_frfs(path);
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
    add_clock(at, set.sample_rate_hz, set.sample_rate_relative_std);
    auto& state = result_.states[at];
    signal::ModalOptions options;
    if (data_.band_hz)
      options.low_hz = data_.band_hz->first, options.high_hz = data_.band_hz->second;
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
      add(at, std::move(mode), {});
    }
    state.modes_lead_only = true;
    for (std::size_t r = 0; r < sensors.size(); ++r) {
      const auto form = form_of(scene.sensors[sensors[r].first].quantity, path);
      const signal::FrfSet same = set.form == form ? set : signal::converted(set, form);
      const double low = data_.band_hz ? data_.band_hz->first : 0;
      const double high =
          data_.band_hz ? data_.band_hz->second : std::numeric_limits<double>::infinity();
      std::vector<Eigen::Index> lines;
      for (Eigen::Index k = 0; k < same.frequency_hz.size(); ++k) {
        const double f = same.frequency_hz[k];
        if (f > 0 && f >= low && f <= high) lines.push_back(k);
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
    switch (quantity) {
      case model::Sensor::Quantity::acceleration:
        return signal::FrfForm::accelerance;
      case model::Sensor::Quantity::velocity:
        return signal::FrfForm::mobility;
      case model::Sensor::Quantity::displacement:
        return signal::FrfForm::receptance;
      case model::Sensor::Quantity::force:
        break;
    }
    throw UsageError(path + ": FRFs of force sensors are not fitted");
  }

  void read_decay(const std::string& path, std::size_t file, std::optional<double> tension) {
    const model::Scene scene = scene_for(file);
    const auto recording = load_recording(path, context_);
    if (data_.decay_channel.empty() && recording.channels.size() != 1) {
      throw UsageError(path + " has several channels: name one with --channel");
    }
    const auto& channel = data_.decay_channel.empty() ? recording.channels.front()
                                                      : recording.channel(data_.decay_channel);
    if (!(recording.sample_rate_hz > 0)) throw UsageError(path + " gives no sample rate");
    signal::DecayOptions options;
    if (data_.band_hz) {
      options.band_low_hz = data_.band_hz->first, options.band_high_hz = data_.band_hz->second;
    }
    const auto decay = signal::estimate_decay(channel.samples, recording.sample_rate_hz, options);
    if (!decay.refusal.empty()) throw Refused(path + ": " + decay.refusal);
    const std::size_t at = state_at(scene_of(file), scene, tension);
    add_clock(at, recording.sample_rate_hz, recording.sample_rate_relative_std);
    for (const auto& found : decay.modes) {
      if (found.doubtful) {
        context_.warn("doubtful", found.doubt, path);
        continue;
      }
      ident::MeasuredMode mode;
      mode.frequency_hz = found.frequency_hz;
      mode.damping_ratio = found.damping_ratio;
      mode.plane = plane_of(file);
      add(at, std::move(mode), {});
    }
  }

  const UpdateData& data_;
  VerbContext& context_;
  std::size_t files_ = 0;
  std::size_t next_tension_ = 0;      ///< next of data_.tensions
  bool modes_have_tensions_ = false;  ///< those of universal files, before the others
  std::size_t taken_ = 0;             // modes of universal files
  bool several_ = false;              // scenes
  UpdateStates result_;
};

}  // namespace

UpdateStates read_update_states(const UpdateData& data, VerbContext& context) {
  return StateReader(data, context).read();
}

}  // namespace rigfit::apps
