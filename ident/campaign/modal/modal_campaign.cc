#include "ident/campaign/modal/modal_campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "signal/recording/recording_error.h"

namespace rigfit::ident {
namespace {

using Eigen::Index;
using signal::Recording;

const char* kRenameRemedy =
    "; name and scale its channels in a TOML file beside it or in the campaign";

/// Why a recording cannot take part; empty: it can.
std::string unusable(const Recording& recording, const HammerTestOptions& hammer,
                     double usual_rate_hz) {
  if (recording.time_s.size() > 0) return "its samples are not evenly spaced in time";
  if (!(recording.sample_rate_hz > 0)) {
    return "gives no sample rate; add sample_rate_hz to its [[test.recording]]";
  }
  if (usual_rate_hz > 0 && std::abs(recording.sample_rate_hz / usual_rate_hz - 1) > 1e-6) {
    return fmt::format(
        "is sampled at {:g} Hz, the others at {:g} Hz; analyse it as a test of its own",
        recording.sample_rate_hz, usual_rate_hz);
  }
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

double usual_rate(const std::vector<ModalRecording>& recordings) {
  std::map<double, int> count;
  for (const auto& one : recordings) ++count[one.recording.sample_rate_hz];
  double best = 0;
  int most = 0;
  for (const auto& [rate, n] : count) {
    if (n > most) best = rate, most = n;
  }
  return best;
}

/// Usable recordings by state, tensions rising, and place struck.
std::vector<ModalTestState> sorted(std::vector<ModalRecording>& recordings,
                                   const HammerTestOptions& hammer,
                                   std::vector<Finding>& findings) {
  std::vector<ModalTestState> states;
  const double rate = usual_rate(recordings);
  for (auto& one : recordings) {
    if (const auto why = unusable(one.recording, hammer, rate); !why.empty()) {
      findings.push_back({"recording", why, one.recording.path.string(), true});
      continue;
    }
    auto state = std::find_if(states.begin(), states.end(), [&](const ModalTestState& known) {
      return known.tension_N == one.tension_N;
    });
    if (state == states.end()) {
      state = states.insert(states.end(), ModalTestState{});
      state->tension_N = one.tension_N;
      state->origin = one.origin;
    }
    auto place = std::find_if(state->places.begin(), state->places.end(),
                              [&](const StruckPlace& known) { return known.name == one.place; });
    if (place == state->places.end()) {
      place = state->places.insert(state->places.end(), StruckPlace{one.place, {}});
    }
    place->recordings.push_back(std::move(one.recording));
  }
  std::stable_sort(
      states.begin(), states.end(),
      [](const ModalTestState& a, const ModalTestState& b) { return a.tension_N < b.tension_N; });
  return states;
}

/// The first accepted hit of a place, for laying the model's answer over it.
RecordedHit first_hit(const StruckPlace& place, const signal::ImpactTest& test,
                      const std::string& force) {
  RecordedHit kept;
  kept.place = place.name;
  const auto& search = test.search;
  kept.rate_hz = search.sample_rate_hz;
  const auto hit = std::find_if(search.hits.begin(), search.hits.end(),
                                [](const signal::Hit& one) { return one.accepted; });
  const Recording& recording = place.recordings[hit->recording];
  const Index n = std::min(search.block_samples, hit->available);
  kept.force = recording.channel(force).samples.segment(hit->block_first, n).array() - hit->offset;
  kept.pulse_first = std::max<Index>(0, hit->pulse_first - hit->block_first - 2);
  kept.pulse_last = std::min(
      n - 1, hit->pulse_last - hit->block_first + 3 * (hit->pulse_last - hit->pulse_first + 1));
  kept.responses.resize(n, static_cast<Index>(test.responses.size()));
  for (std::size_t r = 0; r < test.responses.size(); ++r) {
    kept.responses.col(static_cast<Index>(r)) =
        recording.channels[static_cast<std::size_t>(test.responses[r])]
            .samples.segment(hit->block_first, n)
            .array() -
        search.response_rest[hit->recording][r];
  }
  return kept;
}

Eigen::Vector3d direction_of(const signal::Channel& channel) {
  return {channel.direction[0], channel.direction[1], channel.direction[2]};
}

void analyse(ModalTestState& state, const ModalTestOptions& options) {
  const bool unnamed = state.places.size() == 1 && state.places.front().name.empty();
  for (auto& place : state.places) {
    // Among several places, the one without a name needs one.
    if (!unnamed && place.name.empty()) place.name = "hammer";
  }
  try {
    state.hammer = analyse_hammer_test(state.places, options.hammer);
  } catch (const signal::RecordingError& error) {
    state.findings.push_back({"recording", error.what(), "", true});
    return;
  } catch (const std::invalid_argument& error) {
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
    const auto& place = state.places[p];
    if (state.hammer.tests[p].frfs.averages == 0) continue;
    state.force_directions.push_back(
        direction_of(place.recordings.front().channel(options.hammer.force)));
    state.hits.push_back(first_hit(place, state.hammer.tests[p], options.hammer.force));
  }
  auto modes = identify(state.hammer.frfs, options.hammer.impact.hits.band_hz,
                        state.hammer.usable_hz, options.modal);
  state.modal = std::move(modes.modal);
  state.findings.insert(state.findings.end(), modes.findings.begin(), modes.findings.end());
}

}  // namespace

ModalTest run_modal_test(std::vector<ModalRecording> recordings, const ModalTestOptions& options) {
  ModalTest test;
  test.states = sorted(recordings, options.hammer, test.findings);
  for (auto& state : test.states) analyse(state, options);
  return test;
}

}  // namespace rigfit::ident
