#include "ident/campaign/modal/modal_campaign.h"

#include "signal/recording/add_note.h"

namespace rigfit::ident {
namespace {

using signal::Hit, signal::HitFault, signal::ImpactTest, signal::Recording, signal::StruckPoint;

/// The responses asked for, else every channel besides the force that all recordings have.
std::vector<std::string> response_names(const std::vector<StruckPoint>& places,
                                        const HammerTestOptions& options, Index force,
                                        std::vector<Finding>& findings) {
  const Recording& first = places.front().recordings.front();
  for (const auto& name : options.responses) {
    if (first.channel_index(name) == force) {
      throw std::invalid_argument("\"" + name + "\" is the force: it cannot be a response too");
    }
  }
  if (!options.responses.empty()) return options.responses;
  std::vector<std::string> names;
  for (Index c = 0; c < static_cast<Index>(first.channels.size()); ++c) {
    if (c == force) continue;
    const std::string& title = first.channels[static_cast<std::size_t>(c)].name;
    const bool own = first.channel_index(title) == c;
    const std::string name = own ? title : "#" + std::to_string(c + 1);
    try {
      for (const auto& place : places) {
        for (const auto& recording : place.recordings) (void)recording.channel_index(name);
      }
      names.push_back(name);
    } catch (const signal::RecordingError& error) {
      signal::add_note(
          findings, "data_left_out", title,
          "Name the channel alike in all recordings: {}; it is left out of the responses",
          error.what());
    }
  }
  return names;
}

/// Why no hit was accepted, by the faults that most of them have.
Finding all_rejected(const HammerTest& test) {
  std::map<HitFault, int> count;
  const Hit* first = nullptr;
  for (const ImpactTest& one : test.tests) {
    for (const Hit& hit : one.search.hits) {
      if (first == nullptr) first = &hit;
      for (const HitFault fault : hit.faults) ++count[fault];
    }
  }
  std::string why;
  for (const auto& [fault, hits] : count) {
    why += fmt::format("{}{} ({})", why.empty() ? "" : ", ", name_of(fault), hits);
  }
  const std::size_t total = test.hits();
  return {count.contains(HitFault::unresolved_pulse) ? "pulse_not_resolved" : "no_hit_accepted",
          fmt::format("Repeat the hits: {} of {} rejected ({}), so there is no FRF; first: {}",
                      total, total, why, first->reason),
          "", true};
}

/// Index among the responses of the driving point that the options name.
std::optional<Index> driving_response(const Recording& first, const HammerTestOptions& options,
                                      const std::vector<std::string>& responses) {
  if (options.driving_point.empty()) return {};
  const auto at =
      std::ranges::find(responses, first.channel_index(options.driving_point),
                        [&](const std::string& name) { return first.channel_index(name); });
  if (at != responses.end()) return at - responses.begin();
  throw std::invalid_argument("the driving point \"" + options.driving_point +
                              "\" is not among the responses");
}

/// Why a recording cannot take part; empty: it can.
std::string unusable(const Recording& recording, const ModalTestOptions& options,
                     double usual_rate_hz) {
  const auto& hammer = options.hammer;
  if (const auto uneven = not_uniform(recording)) return uneven->message;
  if (options.ambient) return "";  // its set-ups may have other channels
  if (usual_rate_hz > 0 && std::abs(recording.sample_rate_hz / usual_rate_hz - 1) > 1e-6) {
    return fmt::format(
        "is sampled at {:g} Hz, the others at {:g} Hz; analyse it as a test of its own",
        recording.sample_rate_hz, usual_rate_hz);
  }
  std::vector<std::string> needed = hammer.responses;
  needed.push_back(hammer.force);
  for (const auto& name : needed) {
    try {
      const bool force = name == hammer.force;
      const auto& unit = recording.channel(name).unit;
      if (force ? unit.empty() || unit == "N" : unit != "N") continue;
      return fmt::format(
          "its channel \"{}\" is in {}{}; name and scale its channels in a TOML file beside it or "
          "in the campaign",
          name, unit, force ? ", not in N: it is no force" : ": a force is no response");
    } catch (const signal::RecordingError& error) {
      return fmt::format("has no channel \"{}\": {}", name, error.what());
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
    auto place = std::ranges::find(state->places, one.place, &StruckPoint::name);
    if (place == state->places.end()) {
      place = state->places.insert(state->places.end(), StruckPoint{one.place, {}});
    }
    place->recordings.push_back(std::move(one.recording));
  }
  std::ranges::stable_sort(states, {}, &ModalTestState::tension_N);
  return states;
}

Vector3d direction_of(const signal::Channel& channel) { return Vector3d(channel.direction.data()); }

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
  state.modal = identify(state.hammer.frfs, options.hammer.impact.hits.band_hz,
                         state.hammer.usable_hz, options.modal, state.findings);
}

/// Modes without a force: of each recording, joined by the references.
void analyse_ambient(ModalTestState& state, const ModalTestOptions& options) {
  signal::AmbientOptions ambient;
  ambient.channels = options.hammer.responses;
  if (const auto& band = options.hammer.impact.hits.band_hz) {
    ambient.low_hz = band->first, ambient.high_hz = band->second;
  }
  std::map<std::string, Vector3d> directions;
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
  add_notes(found.notes, state.findings);
  state.channels = found.channels;
  auto& modal = state.modal.emplace();
  modal.low_hz = found.low_hz, modal.high_hz = found.high_hz;
  for (const auto& name : found.channels) {
    state.directions.push_back(directions[name]);
    modal.model.responses.push_back({name, 0, 0});
  }
  for (const auto& one : found.modes) modal.model.modes.push_back(one.mode);
}

/// To the modes' frequencies, those at their points and the covariance of the poles, where it
/// couples all frequencies.
void add_rate_to_model(double relative_std, signal::ModalModel& model) {
  const auto modes = static_cast<Index>(model.modes.size());
  VectorXd by_rate = VectorXd::Zero(2 * modes);
  for (Index r = 0; r < modes; ++r) {
    auto& mode = model.modes[static_cast<std::size_t>(r)];
    by_rate[2 * r] = relative_std * mode.frequency_hz.value;
    add_rate_uncertainty(relative_std, mode.frequency_hz);
    for (auto& point : mode.points) add_rate_uncertainty(relative_std, point.frequency_hz);
  }
  if (model.pole_covariance.rows() == by_rate.size()) {
    model.pole_covariance += by_rate * by_rate.transpose();
  }
}

}  // namespace

std::size_t HammerTest::hits() const {
  std::size_t count = 0;
  for (const ImpactTest& test : tests) count += test.search.hits.size();
  return count;
}

std::size_t HammerTest::accepted_hits() const {
  std::size_t count = 0;
  for (const ImpactTest& test : tests) count += static_cast<std::size_t>(test.frfs.averages);
  return count;
}

HammerTest analyse_hammer_test(std::vector<StruckPoint>& places, const HammerTestOptions& options) {
  HammerTest test;
  const Recording& first = places.front().recordings.front();
  const Index force = first.channel_index(options.force);
  test.force = first.channels[static_cast<std::size_t>(force)].name;
  test.responses = response_names(places, options, force, test.findings);
  if (test.responses.empty()) {
    test.findings.push_back(
        {"no_response",
         "Record the responses too: the test has no channel besides the force that "
         "all recordings have, and so no FRF",
         first.path.string(), true});
    return test;
  }
  if (places.size() == 1 && places.front().name.empty()) {
    places.front().response = driving_response(first, options, test.responses);
  }
  static_cast<signal::RovingHammer&>(test) =
      signal::analyse_roving_hammer(places, options.force, test.responses, options.impact);
  // Where no place is left, that is said for all.
  if (test.frfs.averages == 0) {
    std::erase_if(test.notes, [](const auto& note) { return note.code == "point_left_out"; });
  }
  add_notes(test.notes, test.findings);
  if (test.hits() == 0) {
    test.findings.push_back(
        {"no_hit",
         fmt::format("Check that \"{0}\" is the force and the sign of its pulses: no "
                     "hit in \"{0}\" rises above the noise",
                     test.force),
         first.path.string(), true});
    return test;
  }
  double& rate_std = test.frfs.sample_rate_relative_std;
  for (const auto& place : places) {
    for (const auto& recording : place.recordings) {
      rate_std = std::max(rate_std, recording.sample_rate_relative_std);
    }
  }
  add_notes(test.frfs.notes, test.findings);
  if (test.accepted_hits() == 0) {
    test.findings.push_back(all_rejected(test));
    return test;
  }
  test.usable_hz = std::numeric_limits<double>::infinity();
  for (const ImpactTest& one : test.tests) {
    test.amplitudes = test.amplitudes && one.amplitudes;
    if (one.frfs.averages > 0) test.usable_hz = std::min(test.usable_hz, one.usable_hz);
  }
  return test;
}

std::optional<signal::ModalResult> identify(const signal::FrfSet& frfs,
                                            const std::optional<std::pair<double, double>>& band_hz,
                                            double usable_hz, signal::ModalOptions options,
                                            std::vector<Finding>& findings) {
  options.low_hz = band_hz ? band_hz->first : 0;
  options.high_hz = band_hz ? band_hz->second : usable_hz;
  signal::ModalResult found;
  try {
    found = signal::identify_modes(frfs, options);
  } catch (const std::invalid_argument& error) {
    findings.push_back({"no_modes", error.what(), "", true});
    return std::nullopt;
  }
  const double rate_relative_std = frfs.sample_rate_relative_std;
  if (rate_relative_std > 0 && !found.model.modes.empty()) {
    tell_rate(rate_relative_std, found.model.modes.front().frequency_hz, "", findings);
    add_rate_to_model(rate_relative_std, found.model);
  }
  add_notes(found.model.notes, findings);
  for (const auto& mode : found.model.modes) {
    const bool window = mode.damping_dominated_by_window;
    if (!window && !mode.doubtful) continue;
    findings.push_back({window ? "window_damping" : "doubtful_mode", mode.doubt,
                        fmt::format("{:.4g} Hz", mode.frequency_hz.value), window});
  }
  if (found.end != signal::StepsEnd::converged && !found.model.modes.empty()) {
    signal::add_note(findings, "not_converged", "",
                     "Narrow the band: the refinement ended by {} after {} iterations, so that "
                     "frequencies and damping are near, not at, the best fit",
                     name_of(found.end), found.iterations);
  }
  return found;
}

ModalTest run_modal_test(std::vector<TestRecording> recordings, const ModalTestOptions& options) {
  ModalTest test;
  test.states = sorted(recordings, options, test.findings);
  for (auto& state : test.states) {
    options.ambient ? analyse_ambient(state, options) : analyse(state, options);
  }
  return test;
}

}  // namespace rigfit::ident
