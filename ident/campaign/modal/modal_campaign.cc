#include "ident/campaign/modal/modal_campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "signal/ambient/ambient_modes.h"
#include "signal/recording/recording_error.h"

namespace rigfit::ident {
namespace {

using signal::Recording;

const char* kRenameRemedy =
    "; name and scale its channels in a TOML file beside it or in the campaign";

/// Why a recording cannot take part; empty: it can.
std::string unusable(const Recording& recording, const ModalTestOptions& options,
                     double usual_rate_hz) {
  const auto& hammer = options.hammer;
  if (recording.time_s.size() > 0) return "its samples are not evenly spaced in time";
  if (!(recording.sample_rate_hz > 0)) {
    return "gives no sample rate; add sample_rate_hz to its [[test.recording]]";
  }
  if (!options.ambient && usual_rate_hz > 0 &&
      std::abs(recording.sample_rate_hz / usual_rate_hz - 1) > 1e-6) {
    return fmt::format(
        "is sampled at {:g} Hz, the others at {:g} Hz; analyse it as a test of its own",
        recording.sample_rate_hz, usual_rate_hz);
  }
  if (options.ambient) return "";  // its set-ups may have other channels
  std::vector<std::string> needed = hammer.responses;
  needed.push_back(hammer.force);
  for (const auto& name : needed) {
    try {
      static_cast<void>(recording.channel_index(name));
    } catch (const signal::RecordingError& error) {
      return fmt::format("has no channel \"{}\": {}", name, error.what());
    }
  }
  const auto& force = recording.channel(hammer.force);
  if (!force.unit.empty() && force.unit != "N") {
    return fmt::format("its channel \"{}\" is in {}, not in N: it is no force{}", hammer.force,
                       force.unit, kRenameRemedy);
  }
  for (const auto& name : hammer.responses) {
    const auto& response = recording.channel(name);
    if (response.unit == "N") {
      return fmt::format("its channel \"{}\" is in N: a force is no response{}", name,
                         kRenameRemedy);
    }
  }
  return "";
}

double usual_rate(const std::vector<TestRecording>& recordings) {
  std::map<double, int> count;
  for (const auto& one : recordings) ++count[one.recording.sample_rate_hz];
  const auto most = std::ranges::max_element(count, {}, [](const auto& one) { return one.second; });
  return most == count.end() ? 0 : most->first;
}

/// Usable recordings by state, tensions rising, and place struck.
std::vector<ModalTestState> sorted(std::vector<TestRecording>& recordings,
                                   const ModalTestOptions& options,
                                   std::vector<Finding>& findings) {
  std::vector<ModalTestState> states;
  const double rate = usual_rate(recordings);
  for (auto& one : recordings) {
    if (const auto why = unusable(one.recording, options, rate); !why.empty()) {
      findings.push_back({"recording", why, one.recording.path.string(), true});
      continue;
    }
    auto state = std::ranges::find(states, one.tension_N, &ModalTestState::tension_N);
    if (state == states.end()) {
      state = states.insert(states.end(), ModalTestState{});
      state->tension_N = one.tension_N;
      state->origin = one.origin;
    }
    auto place = std::ranges::find(state->places, one.place, &StruckPlace::name);
    if (place == state->places.end()) {
      place = state->places.insert(state->places.end(), StruckPlace{one.place, {}});
    }
    place->recordings.push_back(std::move(one.recording));
  }
  std::ranges::stable_sort(states, {}, &ModalTestState::tension_N);
  return states;
}

Eigen::Vector3d direction_of(const signal::Channel& channel) {
  return Eigen::Vector3d(channel.direction.data());
}

void analyse(ModalTestState& state, const ModalTestOptions& options) {
  const bool unnamed = state.places.size() == 1 && state.places.front().name.empty();
  for (auto& place : state.places) {
    // Among several places, the one without a name needs one.
    if (!unnamed && place.name.empty()) place.name = "hammer";
  }
  try {
    state.hammer = analyse_hammer_test(state.places, options.hammer);
  } catch (const std::exception& error) {  // RecordingError, std::invalid_argument
    state.findings.push_back({"recording", error.what(), "", true});
    return;
  }
  state.findings = state.hammer.findings;
  if (state.hammer.accepted_hits() == 0) return;
  if (unnamed) state.hammer.frfs.inputs.front() = {"hammer", 0, 0};
  for (const auto& response : state.hammer.frfs.responses) state.channels.push_back(response.name);
  for (const auto& name : state.hammer.responses) {
    state.directions.push_back(direction_of(state.places.front().recordings.front().channel(name)));
  }
  for (std::size_t p = 0; p < state.places.size(); ++p) {
    if (state.hammer.tests[p].frfs.averages == 0) continue;
    const Recording& first = state.places[p].recordings.front();
    state.force_directions.push_back(direction_of(first.channel(options.hammer.force)));
  }
  auto modes = identify(state.hammer.frfs, options.hammer.impact.hits.band_hz,
                        state.hammer.usable_hz, options.modal);
  state.modal = std::move(modes.modal);
  state.findings.insert(state.findings.end(), modes.findings.begin(), modes.findings.end());
}

/// Modes without a force: of each recording, joined by the references.
void analyse_ambient(ModalTestState& state, const ModalTestOptions& options) {
  signal::AmbientOptions ambient;
  ambient.channels = options.hammer.responses;
  if (const auto& band = options.hammer.impact.hits.band_hz) {
    ambient.low_hz = band->first, ambient.high_hz = band->second;
  }
  std::map<std::string, Eigen::Vector3d> directions;
  auto& found = state.ambient.emplace();
  try {
    std::vector<signal::AmbientResult> setups;
    for (const auto& place : state.places) {
      for (const auto& recording : place.recordings) {
        ambient.references = options.references;
        setups.push_back(signal::ambient_modes(recording, ambient));
        for (auto& note : setups.back().notes) note.where = recording.path.string();
        for (const auto& channel : recording.channels) {
          directions.emplace(channel.name, direction_of(channel));
        }
      }
    }
    found = signal::merge_setups(setups, options.references);
  } catch (const std::exception& error) {  // RecordingError, std::invalid_argument
    state.findings.push_back({"recording", error.what(), "", true});
    return;
  }
  add_notes(found.notes, state.findings, "", {"no_modes"});
  state.channels = found.channels;
  auto& modal = state.modal.emplace();
  modal.low_hz = found.low_hz, modal.high_hz = found.high_hz;
  for (const auto& name : found.channels) {
    state.directions.push_back(directions[name]);
    modal.model.responses.push_back({name, 0, 0});
  }
  for (const auto& one : found.modes) modal.model.modes.push_back(one.mode);
}

}  // namespace

ModalTest run_modal_test(std::vector<TestRecording> recordings, const ModalTestOptions& options) {
  ModalTest test;
  test.states = sorted(recordings, options, test.findings);
  for (auto& state : test.states) {
    options.ambient ? analyse_ambient(state, options) : analyse(state, options);
  }
  return test;
}

}  // namespace rigfit::ident
