#include "ident/campaign/modal/hammer_campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <stdexcept>

#include "ident/campaign/single_tests/test_recording.h"
#include "signal/recording/recording_error.h"

namespace rigfit::ident {
namespace {

using Eigen::Index;
using signal::Hit;
using signal::HitFault;
using signal::ImpactTest;
using signal::Recording;

/// The responses asked for, else every channel besides the force that all recordings have.
std::vector<std::string> response_names(std::span<const StruckPlace> places,
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
      findings.push_back(
          {"data_left_out",
           fmt::format("Name the channel alike in all recordings: {}; it is left out "
                       "of the responses",
                       error.what()),
           title});
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
  const Index driving = first.channel_index(options.driving_point);
  for (std::size_t r = 0; r < responses.size(); ++r) {
    if (first.channel_index(responses[r]) == driving) return static_cast<Index>(r);
  }
  throw std::invalid_argument("the driving point \"" + options.driving_point +
                              "\" is not among the responses");
}

void analyse_places(std::span<const StruckPlace> places, const HammerTestOptions& options,
                    HammerTest& test) {
  std::vector<signal::StruckPoint> points;
  for (const auto& place : places) points.push_back({place.name, place.recordings, {}});
  if (places.size() == 1 && places.front().name.empty()) {
    points.front().response =
        driving_response(places.front().recordings.front(), options, test.responses);
  }
  static_cast<signal::RovingHammer&>(test) =
      signal::analyse_roving_hammer(points, options.force, test.responses, options.impact);
  // Where no place is left, that is said for all.
  if (test.frfs.averages == 0) {
    std::erase_if(test.notes, [](const auto& note) { return note.code == "point_left_out"; });
  }
  add_notes(test.notes, test.findings);
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

HammerTest analyse_hammer_test(std::span<const StruckPlace> places,
                               const HammerTestOptions& options) {
  HammerTest test;
  const Recording& first = places.front().recordings.front();
  const Index force = first.channel_index(options.force);
  test.force = first.channels[static_cast<std::size_t>(force)].name;
  test.force_unit = first.channels[static_cast<std::size_t>(force)].unit;
  test.responses = response_names(places, options, force, test.findings);
  if (test.responses.empty()) {
    test.findings.push_back(
        {"no_response",
         "Record the responses too: the test has no channel besides the force that "
         "all recordings have, and so no FRF",
         first.path.string(), true});
    return test;
  }
  analyse_places(places, options, test);
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

IdentifiedModes identify(const signal::FrfSet& frfs,
                         const std::optional<std::pair<double, double>>& band_hz, double usable_hz,
                         signal::ModalOptions options) {
  IdentifiedModes found;
  options.low_hz = band_hz ? band_hz->first : 0;
  options.high_hz = band_hz ? band_hz->second : usable_hz;
  try {
    found.modal = signal::identify_modes(frfs, options);
  } catch (const std::invalid_argument& error) {
    found.findings.push_back({"no_modes", error.what(), "", true});
    return found;
  }
  auto& result = *found.modal;
  const double rate_relative_std = frfs.sample_rate_relative_std;
  if (rate_relative_std > 0 && !result.model.modes.empty()) {
    tell_rate(rate_relative_std, result.model.modes.front().frequency_hz, "", found.findings);
    add_rate_uncertainty(rate_relative_std, result.model);
  }
  add_notes(result.model.notes, found.findings, "", {"no_modes", "rank_deficient"});
  for (const auto& mode : result.model.modes) {
    const std::string where = fmt::format("{:.4g} Hz", mode.frequency_hz.value);
    if (mode.damping_dominated_by_window) {
      found.findings.push_back({"window_damping", mode.doubt, where, true});
    } else if (mode.doubtful) {
      found.findings.push_back({"doubtful_mode", mode.doubt, where, false});
    }
  }
  if (result.end != signal::StepsEnd::converged && !result.model.modes.empty()) {
    found.findings.push_back(
        {"not_converged",
         fmt::format("Narrow the band: the refinement ended by {} after {} iterations, so that "
                     "frequencies and damping are near, not at, the best fit",
                     name_of(result.end), result.iterations),
         "", false});
  }
  return found;
}

}  // namespace rigfit::ident
