#include "apps/cli/impact_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "apps/campaign_file/recording_description.h"
#include "apps/cli/number_checks.h"

namespace rigfit::apps {
namespace {

using signal::HitFault;

signal::ImpactTestOptions options_of(const ImpactCommand& command) {
  signal::ImpactTestOptions options;
  signal::HitOptions& hits = options.hits;
  hits.sign = command.sign == "positive"   ? signal::PulseSign::positive
              : command.sign == "negative" ? signal::PulseSign::negative
                                           : signal::PulseSign::automatic;
  hits.trigger = command.trigger / 100;
  hits.double_hit = command.double_hit / 100;
  hits.max_spectrum_drop_db = command.max_spectrum_drop_db;
  hits.ring_down_level = command.ring_down_level / 100;
  hits.min_pulse_samples = command.min_pulse_samples;
  hits.accept_unresolved = command.frequencies_only;
  hits.block_s = command.block_s;
  hits.pre_trigger_s = command.pre_trigger_s;
  if (!command.band.empty()) {
    if (!(command.band[0] >= 0 && command.band[1] > command.band[0])) {
      throw UsageError("--band needs two frequencies, the lower one first");
    }
    hits.band_hz = {command.band[0], command.band[1]};
  }
  options.estimator = command.estimator == "h2"   ? signal::FrfEstimator::h2
                      : command.estimator == "hv" ? signal::FrfEstimator::hv
                                                  : signal::FrfEstimator::h1;
  if (command.force_window == "auto") {
    options.force_window_s = -1;
  } else if (command.force_window == "off") {
    options.force_window_s = 0;
  } else if (command.force_window != "by-noise") {
    std::size_t used = 0;
    double seconds = 0;
    try {
      seconds = std::stod(command.force_window, &used);
    } catch (const std::exception&) {
      used = 0;
    }
    if (used != command.force_window.size() || !(seconds > 0) || !std::isfinite(seconds)) {
      throw UsageError("--force-window is by-noise, off, auto or a time in seconds, not \"" +
                       command.force_window + "\"");
    }
    options.force_window_s = seconds;
  }
  options.exponential_decay_rate_1_s = command.exponential_window;
  options.exponential_end_level = command.exponential_end_level;
  options.error_smoothing_lines = command.error_smoothing_lines;
  options.reject_outliers = !command.keep_outliers;
  return options;
}

std::vector<std::string> responses_of(const ImpactCommand& command,
                                      const signal::Recording& recording, Eigen::Index force) {
  std::vector<std::string> names;
  for (const std::string& name : command.responses) {
    const Eigen::Index index = recording.channel_index(name);
    if (index == force) {
      throw UsageError("\"" + name + "\" is the force: it cannot be a response too");
    }
    names.push_back(name);
  }
  if (!names.empty()) return names;
  for (Eigen::Index c = 0; c < static_cast<Eigen::Index>(recording.channels.size()); ++c) {
    if (c != force) names.push_back("#" + std::to_string(c + 1));
  }
  if (names.empty()) {
    throw Refused(recording.path.string() + ": has no channel besides the force; there is no FRF");
  }
  return names;
}

void warn_of_notes(VerbContext& context, const std::vector<signal::Note>& notes) {
  for (const signal::Note& note : notes) context.warn(note.code, note.message, note.where);
}

/// Why no hit was accepted, by the faults that most of them have, and what can be had instead.
void refuse_all(VerbContext& context, const ImpactRun& run) {
  std::map<HitFault, int> count;
  const signal::Hit* first = nullptr;
  for (const signal::ImpactTest& test : run.tests) {
    for (const signal::Hit& hit : test.search.hits) {
      if (first == nullptr) first = &hit;
      for (const HitFault fault : hit.faults) ++count[fault];
    }
  }
  std::string why;
  for (const auto& [fault, hits] : count) {
    why += fmt::format("{}{} ({})", why.empty() ? "" : ", ", name_of(fault), hits);
  }
  const std::size_t total = run.hits();
  std::string message = fmt::format("no FRF: {} of {} hit{} rejected: {}; first: {}", total, total,
                                    total == 1 ? "" : "s", why, first->reason);
  if (count.contains(HitFault::unresolved_pulse)) {
    message +=
        "; --frequencies-only keeps frequencies and damping without amplitudes, and "
        "--min-pulse-samples accepts shorter pulses from a logger with anti-alias filters";
  }
  context.refuse(
      count.contains(HitFault::unresolved_pulse) ? "pulse_not_resolved" : "no_hit_accepted",
      message);
}

}  // namespace

ImpactCommand::ImpactCommand() {
  const signal::HitOptions hits;
  trigger = 100 * hits.trigger;
  double_hit = 100 * hits.double_hit;
  max_spectrum_drop_db = hits.max_spectrum_drop_db;
  ring_down_level = 100 * hits.ring_down_level;
  min_pulse_samples = hits.min_pulse_samples;
  error_smoothing_lines = signal::FrfOptions().error_smoothing_lines;
}

void add_impact_options(CLI::App& verb, ImpactCommand& c, bool with_files) {
  if (with_files) {
    verb.add_option("FILE", c.files, "Recordings (CSV, LVM, UFF 58): continuous or one a hit")
        ->required();
  }
  auto* force = verb.add_option("--force", c.force, "Force channel: name or #k")->type_name("C");
  if (with_files) force->required();
  verb.add_option("--response", c.responses, "Response channels [every other]")->type_name("C");
  verb.add_option("--driving-point", c.driving_point, "The response at the point struck")
      ->type_name("C");
  verb.add_option("--struck", c.struck,
                  "Point struck in each file, one a file (roving hammer): a response's name where "
                  "it was struck, else any name")
      ->type_name("P");
  verb.add_option("--estimator", c.estimator, "h1: noise on responses, h2: on force, hv: both")
      ->check(CLI::IsMember({"h1", "h2", "hv"}))
      ->capture_default_str();
  verb.add_option(
          "--force-window", c.force_window,
          "Seconds of force kept from the pulse's start, auto (three pulse lengths), off, or "
          "by-noise: auto where the noise on the force matters, else off")
      ->capture_default_str();
  auto* rate = verb.add_option("--exponential-window", c.exponential_window,
                               "Decay rate of a window on force and responses, 1/s; its damping is "
                               "carried along and taken off the poles again")
                   ->check(number_within(0.0, 1e6))
                   ->capture_default_str();
  verb.add_option("--exponential-end-level", c.exponential_end_level,
                  "The same, given as its level at the end of the block")
      ->check(number_within(1e-12, 1.0))
      ->excludes(rate);
  verb.add_option("--band", c.band, "Band in which the force spectrum is asked for, Hz")
      ->expected(2)
      ->type_name("LO HI");
  verb.add_option("--sample-rate", c.sample_rate_hz, "Hz, for files that do not say")
      ->check(positive_number());
  verb.add_option("--block", c.block_s, "Seconds analysed a hit [what uses most of the recordings]")
      ->check(positive_number());
  verb.add_option("--pre-trigger", c.pre_trigger_s, "Seconds before the peak [1 % of the block]")
      ->check(not_negative_number());
  const std::string limits = "Limits on hits";
  verb.add_option("--pulse-sign", c.sign, "Side to which the force goes when hit")
      ->check(CLI::IsMember({"auto", "positive", "negative"}))
      ->capture_default_str()
      ->group(limits);
  verb.add_option("--trigger", c.trigger, "A hit exceeds this much of the largest force, %")
      ->check(number_within(0.1, 100.0))
      ->capture_default_str()
      ->group(limits);
  verb.add_option("--double-hit", c.double_hit, "Smallest second contact objected to, % of the hit")
      ->check(number_within(0.1, 100.0))
      ->capture_default_str()
      ->group(limits);
  verb.add_option("--min-pulse-samples", c.min_pulse_samples,
                  "Samples a pulse needs above 10 % of its peak")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str()
      ->group(limits);
  verb.add_option("--max-spectrum-drop", c.max_spectrum_drop_db,
                  "Drop of the force spectrum within the band, dB (ISO 7626-5)")
      ->check(positive_number())
      ->capture_default_str()
      ->group(limits);
  verb.add_option("--ring-down-level", c.ring_down_level,
                  "A ring-down may be cut once it has fallen to this, % of its largest value")
      ->check(number_within(1e-6, 100.0))
      ->capture_default_str()
      ->group(limits);
  verb.add_flag("--keep-outliers", c.keep_outliers, "No leave-one-out test")->group(limits);
  verb.add_flag("--frequencies-only", c.frequencies_only,
                "Keep hits whose pulse is not resolved; the FRFs then have no scale")
      ->group(limits);
  verb.add_option("--error-smoothing", c.error_smoothing_lines,
                  "Lines on either side over which the noise under error bars is averaged")
      ->check(CLI::Range(0L, 1000000L))
      ->capture_default_str();
}

std::size_t ImpactRun::hits() const {
  std::size_t count = 0;
  for (const signal::ImpactTest& test : tests) count += test.search.hits.size();
  return count;
}

ImpactRun run_impact_test(VerbContext& context, const ImpactCommand& command) {
  signal::ImpactTestOptions options = options_of(command);
  options.threads = context.threads;
  if (!command.struck.empty() && command.struck.size() != command.files.size()) {
    throw UsageError(fmt::format("--struck names {} points for {} files: one a file",
                                 command.struck.size(), command.files.size()));
  }
  if (!command.struck.empty() && !command.driving_point.empty()) {
    throw UsageError("--driving-point is for one point; --struck names every file's point");
  }
  ImpactRun run;
  signal::ReadOptions read;
  read.sample_rate_hz = command.sample_rate_hz;
  for (std::size_t f = 0; f < command.files.size(); ++f) {
    const std::string point = command.struck.empty() ? "" : command.struck[f];
    const auto known = std::find(run.points.begin(), run.points.end(), point);
    const auto p = static_cast<std::size_t>(known - run.points.begin());
    if (known == run.points.end()) {
      run.points.push_back(point);
      run.recordings.emplace_back();
    }
    run.recordings[p].push_back(load_recording(command.files[f], context, read));
  }
  const signal::Recording& first = run.recordings.front().front();
  const Eigen::Index force = first.channel_index(command.force);
  run.force = first.channels[static_cast<std::size_t>(force)].name;
  run.force_unit = first.channels[static_cast<std::size_t>(force)].unit;
  const std::vector<std::string> responses = responses_of(command, first, force);
  if (!command.driving_point.empty()) {
    const Eigen::Index driving = first.channel_index(command.driving_point);
    for (std::size_t r = 0; r < responses.size(); ++r) {
      if (first.channel_index(responses[r]) == driving) {
        options.driving_response = static_cast<Eigen::Index>(r);
      }
    }
    if (!options.driving_response) {
      throw UsageError("--driving-point \"" + command.driving_point +
                       "\" is not among the responses");
    }
  }
  if (command.struck.empty()) {
    run.tests.push_back(
        signal::analyse_impact_test(run.recordings.front(), command.force, responses, options));
    const signal::ImpactTest& test = run.tests.front();
    run.frfs = test.frfs;
    if (test.driving_point) {
      run.driving_points.push_back({*options.driving_response, 0, *test.driving_point});
    }
    warn_of_notes(context, test.notes);
  } else {
    std::vector<signal::StruckPoint> points;
    for (std::size_t p = 0; p < run.points.size(); ++p) {
      points.push_back({run.points[p], run.recordings[p]});
    }
    signal::RovingHammer roving =
        signal::analyse_roving_hammer(points, command.force, responses, options);
    run.tests = std::move(roving.tests);
    run.frfs = std::move(roving.frfs);
    run.driving_points = std::move(roving.driving_points);
    run.reciprocity = std::move(roving.reciprocity);
    warn_of_notes(context, roving.notes);
  }
  if (run.hits() == 0) {
    throw Refused(first.path.string() + ": no hit in \"" + run.force +
                  "\": nothing rises above the noise; is it the force, and is --pulse-sign right?");
  }
  warn_of_notes(context, run.frfs.notes);
  run.usable_hz = std::numeric_limits<double>::infinity();
  std::size_t accepted = 0;
  for (const signal::ImpactTest& test : run.tests) {
    accepted += static_cast<std::size_t>(test.frfs.averages);
    run.amplitudes = run.amplitudes && test.amplitudes;
    if (test.frfs.averages > 0) run.usable_hz = std::min(run.usable_hz, test.usable_hz);
  }
  if (accepted == 0) {
    run.usable_hz = 0;
    refuse_all(context, run);
  } else if (accepted < run.hits()) {
    context.warn("hits_rejected", fmt::format("{} of {} hits rejected; see hits[].reason",
                                              run.hits() - accepted, run.hits()));
  }
  return run;
}

Json hits_json(const ImpactRun& run) {
  Json hits = Json::array();
  for (std::size_t p = 0; p < run.tests.size(); ++p) {
    for (const signal::Hit& hit : run.tests[p].search.hits) {
      Json faults = Json::array();
      for (const HitFault fault : hit.faults) faults.push_back(name_of(fault));
      Json one{{"file", run.recordings[p][hit.recording].path.string()},
               {"time_s", hit.time_s},
               {"peak", hit.peak},
               {"accepted", hit.accepted},
               {"reason", hit.reason},
               {"faults", std::move(faults)},
               {"pulse_samples", hit.pulse_last - hit.pulse_first + 1},
               {"pulse_duration_s", hit.pulse_duration_s},
               {"usable_hz", hit.usable_hz},
               {"end_level", hit.end_level}};
      if (hit.second_hit > 0) {
        one["second_hit"] = {{"ratio", hit.second_hit}, {"delay_s", hit.second_hit_delay_s}};
      }
      if (!run.points[p].empty()) one["struck"] = run.points[p];
      hits.push_back(std::move(one));
    }
  }
  return hits;
}

Json force_window_json(const ImpactRun& run) {
  double kept = 0, left = 0;
  std::optional<double> before;
  bool chosen = false;
  for (const signal::ImpactTest& test : run.tests) {
    if (test.frfs.averages == 0) continue;
    kept = std::max(kept, test.force_window_s);
    left = std::max(left, test.force_noise_left);
    chosen = chosen || test.force_window_by_noise;
    if (test.force_noise) before = std::max(before.value_or(0), *test.force_noise);
  }
  return {{"kept_s", kept > 0 ? Json(kept) : Json(nullptr)},
          {"chosen_by", chosen ? "noise" : "option"},
          {"force_noise", before ? Json(*before) : Json(nullptr)},
          {"force_noise_left", before ? Json(left) : Json(nullptr)}};
}

}  // namespace rigfit::apps
