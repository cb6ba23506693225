#include "apps/report/modal/struck_recordings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "apps/report/parts/recording_blocks.h"
#include "signal/recording/recording_error.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;

const char* kRenameRemedy =
    "; name and scale its channels in a TOML file beside it or in the campaign";

/// Why a recording cannot take part; empty: it can.
std::string unusable(const signal::Recording& recording, const HammerTest& hammer,
                     double usual_rate_hz) {
  if (recording.time_s.size() > 0) return "its samples are not evenly spaced in time";
  if (!(recording.sample_rate_hz > 0)) {
    return "gives no sample rate; add sample_rate_hz to its [[test.recording]]";
  }
  if (usual_rate_hz > 0 && std::abs(recording.sample_rate_hz / usual_rate_hz - 1) > 1e-6) {
    return fmt::format(
        "is sampled at {:g} Hz, the others at {:g} Hz; analyse it as a test of its "
        "own",
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

double usual_rate(const std::vector<LoadedRecording>& loaded) {
  std::map<double, int> count;
  for (const auto& entry : loaded) {
    if (entry.recording) ++count[entry.recording->sample_rate_hz];
  }
  double best = 0;
  int most = 0;
  for (const auto& [rate, n] : count) {
    if (n > most) best = rate, most = n;
  }
  return best;
}

}  // namespace

std::vector<StruckState> sorted_recordings(const CampaignTest& test,
                                           std::vector<LoadedRecording>& loaded, ReportPart& part) {
  std::vector<StruckState> states;
  const double rate = usual_rate(loaded);
  for (auto& entry : loaded) {
    if (!entry.recording) continue;
    if (const auto why = unusable(*entry.recording, test.hammer, rate); !why.empty()) {
      refuse(part, "recording", why, entry.file);
      continue;
    }
    const auto& group = test.recordings[entry.group];
    auto state = std::find_if(states.begin(), states.end(), [&](const StruckState& one) {
      return one.tension_N == group.tension_N;
    });
    if (state == states.end())
      state = states.insert(states.end(), StruckState{group.tension_N, {}});
    auto struck = std::find_if(state->struck.begin(), state->struck.end(),
                               [&](const Struck& one) { return one.load == group.load; });
    if (struck == state->struck.end()) {
      struck = state->struck.insert(state->struck.end(),
                                    Struck{group.load, {}, group.origin(), std::nullopt});
    }
    struck->recordings.push_back(std::move(*entry.recording));
  }
  std::stable_sort(states.begin(), states.end(), [](const StruckState& a, const StruckState& b) {
    return a.tension_N < b.tension_N;
  });
  return states;
}

std::vector<std::string> response_names(const CampaignTest& test,
                                        const std::vector<Struck>& struck) {
  if (!test.hammer.responses.empty()) return test.hammer.responses;
  std::vector<std::string> names;
  const auto& first = struck.front().recordings.front();
  const Index force = first.channel_index(test.hammer.force);
  for (Index c = 0; c < static_cast<Index>(first.channels.size()); ++c) {
    const auto& name = first.channels[static_cast<std::size_t>(c)].name;
    const bool everywhere = std::all_of(struck.begin(), struck.end(), [&](const Struck& one) {
      return std::all_of(one.recordings.begin(), one.recordings.end(), [&](const auto& recording) {
        return std::any_of(recording.channels.begin(), recording.channels.end(),
                           [&](const auto& channel) { return channel.name == name; });
      });
    });
    if (c != force && everywhere) names.push_back(name);
  }
  return names;
}

signal::ImpactTestOptions impact_options(const CampaignTest& test) {
  signal::ImpactTestOptions options;
  options.estimator = test.hammer.estimator == "h2"   ? signal::FrfEstimator::h2
                      : test.hammer.estimator == "hv" ? signal::FrfEstimator::hv
                                                      : signal::FrfEstimator::h1;
  if (test.hammer.force_window_s > 0) options.force_window_s = test.hammer.force_window_s;
  options.exponential_end_level = test.hammer.exponential_end_level;
  options.hits.band_hz = test.band_hz;
  return options;
}

signal::FrfSet merged(const std::vector<Struck>& struck) {
  signal::FrfSet set = struck.front().test->frfs;
  set.inputs.clear();
  for (const auto& one : struck)
    set.inputs.push_back({one.load.empty() ? "hammer" : one.load, 0, 0});
  const auto inputs = static_cast<Index>(struck.size());
  const auto responses = static_cast<Index>(set.responses.size());
  if (inputs == 1) return set;
  const Index lines = set.frequency_hz.size();
  set.H.resize(lines, responses * inputs);
  set.H_std.resize(lines, responses * inputs);
  set.coherence.resize(lines, responses * inputs);
  bool errors = true, coherence = true;
  for (Index i = 0; i < inputs; ++i) {
    const auto& frfs = struck[static_cast<std::size_t>(i)].test->frfs;
    set.averages = std::min(set.averages, frfs.averages);
    errors = errors && frfs.H_std.size() > 0;
    coherence = coherence && frfs.coherence.size() > 0;
    for (Index r = 0; r < responses; ++r) {
      set.H.col(set.column(r, i)) = frfs.H.col(r);
      if (errors) set.H_std.col(set.column(r, i)) = frfs.H_std.col(r);
      if (coherence) set.coherence.col(set.column(r, i)) = frfs.coherence.col(r);
    }
  }
  if (!errors) set.H_std.resize(0, 0);
  if (!coherence) set.coherence.resize(0, 0);
  return set;
}

RecordedHit recorded_hit(const Struck& struck, const std::string& force) {
  RecordedHit kept;
  kept.load = struck.load;
  const auto& search = struck.test->search;
  kept.rate_hz = search.sample_rate_hz;
  for (const auto& hit : search.hits) {
    if (!hit.accepted) continue;
    const auto& recording = struck.recordings[hit.recording];
    const Index n = std::min(search.block_samples, hit.available);
    const auto& responses = struck.test->responses;
    kept.force = recording.channel(force).samples.segment(hit.block_first, n).array() - hit.offset;
    kept.pulse_first = std::max<Index>(0, hit.pulse_first - hit.block_first - 2);
    kept.pulse_last = std::min(
        n - 1, hit.pulse_last - hit.block_first + 3 * (hit.pulse_last - hit.pulse_first + 1));
    kept.responses.resize(n, static_cast<Index>(responses.size()));
    for (std::size_t r = 0; r < responses.size(); ++r) {
      kept.responses.col(static_cast<Index>(r)) =
          recording.channels[static_cast<std::size_t>(responses[r])]
              .samples.segment(hit.block_first, n)
              .array() -
          search.response_rest[hit.recording][r];
    }
    break;
  }
  return kept;
}

}  // namespace rigfit::apps
