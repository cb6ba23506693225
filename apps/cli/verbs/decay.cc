// rigfit decay: frequency and damping of a free decay, with what the decay looks like.
#include "ident/campaign/single_tests/decay_campaign.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>

#include "apps/campaign_file/recording_description.h"
#include "apps/cli/exit_code.h"
#include "apps/cli/json_document.h"
#include "apps/cli/plots/verb_figures.h"
#include "apps/cli/verbs/all.h"
#include "apps/cli/verbs/calls.h"
#include "apps/describe/digits.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;

constexpr const char* kDecayExample = R"(Example:
  rigfit decay tap.csv --channel tension
  rigfit decay swing.csv --channel gyro --start 1.5 --end 20 --band 0.4 1 --json -
  rigfit decay taps.csv --channel tension --each
Times are those of the file. Without --start the decay is looked for: after an impact, after
clipped samples, up to the next impact. All decays of the record are listed, the strongest is
fitted; with --each every one is, and their modes are pooled. Frequencies are undamped natural ones,
f sqrt(1 - zeta^2) is given as damped_frequency_hz. With --band, decays are looked for in the band;
modes outside are fitted but not reported.)";

Json json_of(const signal::DecayMode& mode, double window_s) {
  Json out;
  out["frequency_hz"] = json_estimate(mode.frequency_hz.value, mode.frequency_hz.std);
  out["damping_ratio"] = json_estimate(mode.damping_ratio.value, mode.damping_ratio.std);
  const auto interval = [](const signal::Interval& i) { return Json::array({i.low, i.high}); };
  out["frequency_interval_95_hz"] = interval(mode.frequency_interval_95_hz);
  out["damping_ratio_interval_95"] = interval(mode.damping_ratio_interval_95);
  out["damped_frequency_hz"] =
      json_estimate(mode.damped_frequency_hz.value, mode.damped_frequency_hz.std);
  out["log_decrement"] = json_estimate(mode.log_decrement.value, mode.log_decrement.std);
  out["damping_ratio_log_decrement"] = json_number(mode.damping_ratio_log_decrement.value);
  if (!mode.log_decrement_refusal.empty()) {
    out["log_decrement_refusal"] = mode.log_decrement_refusal;
  } else {
    out["damping_ratio_log_decrement_std"] = json_number(mode.damping_ratio_log_decrement.std);
  }
  out["cycles"] = mode.cycles;
  out["r_squared"] = mode.r_squared;
  out["detection"] = mode.detection;
  out["doubtful"] = mode.doubtful;
  if (mode.doubtful) out["doubt"] = mode.doubt;
  out["amplitude"] = mode.amplitude;
  out["phase_rad"] = mode.phase_rad;
  out["time_constants"] =
      mode.damping_ratio.value * 2 * std::numbers::pi * mode.frequency_hz.value * window_s;
  return out;
}

Json json_of(const signal::EnvelopeResult& envelope, double start_s) {
  Json out;
  out["law"] = signal::name_of(envelope.law);
  out["damping_per_log_amplitude"] = json_estimate(envelope.damping_per_log_amplitude.value,
                                                   envelope.damping_per_log_amplitude.std);
  Json points = Json::array();
  for (const auto& p : envelope.points) {
    points.push_back(
        {{"time_s", start_s + p.time_s},
         {"amplitude", p.amplitude},
         {"frequency_hz", json_estimate(p.frequency_hz.value, p.frequency_hz.std)},
         {"damping_ratio", json_estimate(p.damping_ratio.value, p.damping_ratio.std)}});
  }
  out["points"] = std::move(points);
  return out;
}

std::string value_of(const signal::Estimate& e) { return value_digits(e.value, e.std); }
std::string std_of(const signal::Estimate& e) { return std_digits(e.std); }

void print(const DecayCommand& command, const signal::Channel& channel, double start_s,
           double end_s, const signal::DecayResult& r, std::ostream& out) {
  const std::string unit = channel.unit.empty() ? "" : " " + channel.unit;
  fmt::print(out, "{}: channel {}, fitted from {:.6g} s to {:.6g} s ({} samples)\n", command.file,
             channel.name, start_s, end_s, r.end - r.start);
  if (r.modes.empty()) return;
  fmt::print(out, "noise {:.3g}{} rms, signal to noise {:.1f} dB at the start\n\n", r.noise_std,
             unit, r.signal_to_noise_db);
  fmt::print(out, "{:>14} {:>10} {:>12} {:>10} {:>23} {:>8} {:>8} {:>11}\n", "frequency Hz", "std",
             "damping", "std", "damping (log decrement)", "cycles", "R2", "amplitude");
  for (const auto& m : r.modes) {
    const double ruler = m.damping_ratio_log_decrement.value;
    fmt::print(out, "{:>14} {:>10} {:>12} {:>10} {:>23} {:>8.1f} {:>8.4f} {:>11.4g}\n",
               value_of(m.frequency_hz), std_of(m.frequency_hz), value_of(m.damping_ratio),
               std_of(m.damping_ratio), std::isfinite(ruler) ? fmt::format("{:.5g}", ruler) : "-",
               m.cycles, m.r_squared, m.amplitude);
  }
  if (r.envelope.points.size() < 2) return;
  fmt::print(
      out, "\nalong the decay of the first ({}):\n{:>10} {:>12} {:>14} {:>10} {:>12} {:>10}\n",
      signal::name_of(r.envelope.law), "time s", "amplitude", "damped Hz", "std", "damping", "std");
  for (const auto& p : r.envelope.points) {
    fmt::print(out, "{:>10.4g} {:>12.4g} {:>14} {:>10} {:>12} {:>10}\n", start_s + p.time_s,
               p.amplitude, value_of(p.frequency_hz), std_of(p.frequency_hz),
               value_of(p.damping_ratio), std_of(p.damping_ratio));
  }
  fmt::print(out, "frequency drift {} Hz (std {})\n", value_of(r.envelope.frequency_drift_hz),
             std_of(r.envelope.frequency_drift_hz));
}

Json decays_json(const ident::ChannelDecays& found) {
  Json all = Json::array();
  for (const auto& decay : found.decays) {
    Json one{{"start_s", decay.start_s}, {"end_s", decay.end_s}, {"fitted", decay.fitted}};
    if (decay.result) {
      one["modes"] = Json::array();
      for (const auto& mode : decay.result->modes) {
        one["modes"].push_back(json_of(mode, decay.end_s - decay.start_s));
      }
      if (!decay.fitted) one["refusal"] = decay.result->refusal;
    }
    all.push_back(std::move(one));
  }
  return all;
}

Json pooled_json(const std::vector<ident::PooledMode>& modes) {
  Json all = Json::array();
  const auto interval = [](const signal::Interval& i) { return Json::array({i.low, i.high}); };
  for (const auto& m : modes) {
    all.push_back({{"frequency_hz", json_estimate(m.frequency_hz.value, m.frequency_hz.std)},
                   {"damping_ratio", json_estimate(m.damping_ratio.value, m.damping_ratio.std)},
                   {"frequency_interval_95_hz", interval(m.frequency_interval_95_hz)},
                   {"damping_ratio_interval_95", interval(m.damping_ratio_interval_95)},
                   {"frequency_scatter_hz", m.frequency_scatter_hz},
                   {"damping_ratio_scatter", m.damping_ratio_scatter},
                   {"decays", m.decays}});
  }
  return all;
}

void print(const ident::ChannelDecays& found, std::ostream& out) {
  fmt::print(out, "\n{} decays of the record:\n{:>12} {:>12}  {:>14} {:>10} {:>12} {:>10}\n",
             found.decays.size(), "start s", "end s", "frequency Hz", "std", "damping", "std");
  for (const auto& decay : found.decays) {
    if (!decay.fitted || decay.result->modes.empty()) {
      fmt::print(out, "{:>12.6g} {:>12.6g}  not fitted\n", decay.start_s, decay.end_s);
      continue;
    }
    const auto& m = decay.result->modes.front();
    fmt::print(out, "{:>12.6g} {:>12.6g}  {:>14} {:>10} {:>12} {:>10}\n", decay.start_s,
               decay.end_s, value_of(m.frequency_hz), std_of(m.frequency_hz),
               value_of(m.damping_ratio), std_of(m.damping_ratio));
  }
  fmt::print(out,
             "\npooled over decays (mean, its standard uncertainty, scatter between decays):\n");
  for (const auto& m : found.pooled) {
    fmt::print(out, "{:>14} Hz {:>9} {:>9}   damping {:>10} {:>9} {:>9}   {} decays\n",
               value_of(m.frequency_hz), std_of(m.frequency_hz), std_digits(m.frequency_scatter_hz),
               value_of(m.damping_ratio), std_of(m.damping_ratio),
               std_digits(m.damping_ratio_scatter), m.decays);
  }
}

ident::DecayTest run_decay_test(const signal::Recording& recording, const signal::Channel& channel,
                                const DecayCommand& command) {
  ident::DecayTestOptions options;
  options.start_s = command.start_s, options.end_s = command.end_s, options.each = command.each;
  options.decay.max_modes = command.max_modes;
  const double nyquist = 0.5 * recording.sample_rate_hz;
  if (!command.band.empty()) {
    if (!(command.band[0] >= 0 && command.band[0] < command.band[1] && command.band[0] < nyquist)) {
      throw UsageError(
          fmt::format("--band {} {} must rise and begin below half the sample rate, {} Hz",
                      command.band[0], command.band[1], nyquist));
    }
    options.decay.band_low_hz = command.band[0], options.decay.band_high_hz = command.band[1];
  }
  signal::Recording one = recording;
  one.channels = {channel};
  try {
    return ident::run_decay_test(one, options);
  } catch (const std::invalid_argument& error) {
    throw UsageError(std::string("--start, --end: ") + error.what());
  }
}

Json run(const DecayCommand& command, VerbContext& context) {
  signal::ReadOptions reading;
  reading.sample_rate_hz = command.sample_rate_hz;
  return decay_result(load_recording(command.file, context, reading), command, context);
}

}  // namespace

Json decay_result(const signal::Recording& recording, const DecayCommand& command,
                  VerbContext& context) {
  const auto& channel = chosen_channel(recording, command.channel);
  if (!(recording.sample_rate_hz > 0)) {
    throw UsageError(command.file + " gives no sample rate: say it with --sample-rate");
  }
  const double rate = recording.sample_rate_hz;
  Json result;
  result["channel"] = channel.name;
  result["unit"] = channel.unit;
  result["sample_rate_hz"] = rate;
  result["modes"] = Json::array();
  const auto test = run_decay_test(recording, channel, command);
  const auto tell = [&](const std::vector<ident::Finding>& findings) {
    for (const auto& f : findings) {
      const std::string where = command.file + (f.where.empty() ? "" : ": " + f.where);
      if (f.refused) {
        context.refuse(f.code, f.message, where);
      } else {
        context.warn(f.code, f.message, where);
      }
    }
  };
  tell(test.findings);
  if (test.channels.empty()) return result;
  const auto& found = test.channels.front();
  const auto& r = found.strongest;
  tell(found.findings);
  if (context.plots) draw_decay(*context.plots, command.file, found);
  result["window"] = {
      {"start_s", found.start_s}, {"end_s", found.end_s}, {"samples", r.end - r.start}};
  result["decays_found"] = found.decays.size();
  result["decays"] = decays_json(found);
  if (!r.refusal_code.empty()) return result;
  const double window_s = static_cast<double>(r.end - r.start) / rate;
  Json modes = Json::array(), tones = Json::array();
  for (const auto& mode : r.modes) modes.push_back(json_of(mode, window_s));
  for (const auto& tone : r.steady_tones) {
    tones.push_back(
        {{"frequency_hz", tone.damped_frequency_hz.value}, {"amplitude", tone.amplitude}});
  }
  result["modes"] = std::move(modes);
  if (command.each) result["pooled"] = pooled_json(found.pooled);
  result["frequency_drift_hz"] = json_number(r.envelope.frequency_drift_hz.value);
  result["frequency_drift_std_hz"] = json_number(r.envelope.frequency_drift_hz.std);
  result["amplitude_dependence"] = json_of(r.envelope, found.start_s);
  result["steady_tones"] = std::move(tones);
  result["noise_std"] = r.noise_std;
  result["signal_to_noise_db"] = r.signal_to_noise_db;
  result["residual_order"] = r.residual_order;
  result["degrees_of_freedom"] = r.degrees_of_freedom;
  print(command, channel, found.start_s, found.end_s, r, context.out);
  if (command.each) print(found, context.out);
  return result;
}

describe::Options options_of(DecayCommand& c) {
  using describe::option;
  return {
      option("file", c.file, "Recording").required().type("FILE"),
      option("--channel", c.channel, "Name or #number; may be left out where there is one")
          .type("C"),
      option("--start", c.start_s, "Fit from this time on, s (default: found)").type("S"),
      option("--end", c.end_s, "Use nothing after this time", "s").type("S"),
      option("--band", c.band, "Report modes between these", "Hz").count(2).type("HZ"),
      option(
          "--each", c.each,
          "Fit every decay of the record and pool their modes: mean, and scatter between decays"),
      option("--max-modes", c.max_modes, "At most so many modes").within(1, 12),
      option("--sample-rate", c.sample_rate_hz, "Where the file gives none", "Hz")
          .positive()
          .type("HZ")};
}

Verb decay_verb() {
  Verb verb = verb_of<DecayCommand>(
      "decay", "Frequency and damping of a free decay", kDecayExample,
      [](const DecayCommand& c, VerbContext& context) { return run(c, context); });
  verb.draws = true;
  verb.reads = true;
  return verb;
}

}  // namespace rigfit::apps
