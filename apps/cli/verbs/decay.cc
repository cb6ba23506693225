// rigfit decay: frequency and damping of a free decay, with what the decay looks like.
#include "signal/decay/decay.h"

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
#include "apps/cli/number_checks.h"
#include "apps/cli/verbs/all.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;

struct DecayCommand {
  std::string file, channel;
  std::optional<double> start_s, end_s;
  std::vector<double> band;
  double sample_rate_hz = 0;
  int max_modes = signal::DecayOptions{}.max_modes;
};

constexpr const char* kDecayExample = R"(Example:
  rigfit decay tap.csv --channel tension
  rigfit decay swing.csv --channel gyro --start 1.5 --end 20 --band 0.4 1 --json -
Times are those of the file. Without --start the decay is looked for: after an impact, after
clipped samples, up to the next impact. Frequencies are undamped natural ones, f sqrt(1 - zeta^2)
is given as damped_frequency_hz. With --band, modes outside are fitted but not reported.)";

Json json_of(const signal::DecayMode& mode, double window_s) {
  Json out;
  out["frequency_hz"] = json_estimate(mode.frequency_hz.value, mode.frequency_hz.std);
  out["damping_ratio"] = json_estimate(mode.damping_ratio.value, mode.damping_ratio.std);
  const auto interval = [](const signal::Interval& i) { return Json::array({i.low, i.high}); };
  out["frequency_interval_95_hz"] = interval(mode.frequency_interval_95_hz);
  out["damping_ratio_interval_95"] = interval(mode.damping_ratio_interval_95);
  out["damped_frequency_hz"] =
      json_estimate(mode.damped_frequency_hz.value, mode.damped_frequency_hz.std);
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

Index sample_at(const signal::Recording& recording, double time_s, bool up) {
  const double j = (time_s - recording.start_time_s) * recording.sample_rate_hz;
  const double n = static_cast<double>(recording.samples());
  // Times as printed are rounded: a millionth of a sample past one is that one.
  return static_cast<Index>(
      std::clamp(up ? std::ceil(j - 1e-6) : std::floor(j + 1e-6) + 1, 0.0, n));
}

void print(const DecayCommand& command, const signal::Channel& channel, double start_s,
           double end_s, const signal::DecayResult& r, std::ostream& out) {
  const std::string unit = channel.unit.empty() ? "" : " " + channel.unit;
  fmt::print(out, "{}: channel {}, fitted from {:.6g} s to {:.6g} s ({} samples)\n", command.file,
             channel.name, start_s, end_s, r.end - r.start);
  if (r.modes.empty()) return;
  fmt::print(out, "noise {:.3g}{} rms, signal to noise {:.1f} dB at the start\n\n", r.noise_std,
             unit, r.signal_to_noise_db);
  fmt::print(out, "{:>14} {:>10} {:>12} {:>10} {:>14} {:>8} {:>8} {:>11}\n", "frequency Hz", "std",
             "damping", "std", "log decrement", "cycles", "R2", "amplitude");
  for (const auto& m : r.modes) {
    const double ruler = m.damping_ratio_log_decrement.value;
    fmt::print(out, "{:>14.7g} {:>10.2g} {:>12.5g} {:>10.2g} {:>14} {:>8.1f} {:>8.4f} {:>11.4g}\n",
               m.frequency_hz.value, m.frequency_hz.std, m.damping_ratio.value, m.damping_ratio.std,
               std::isfinite(ruler) ? fmt::format("{:.5g}", ruler) : "-", m.cycles, m.r_squared,
               m.amplitude);
  }
  if (r.envelope.points.size() < 2) return;
  fmt::print(
      out, "\nalong the decay of the first ({}):\n{:>10} {:>12} {:>14} {:>10} {:>12} {:>10}\n",
      signal::name_of(r.envelope.law), "time s", "amplitude", "damped Hz", "std", "damping", "std");
  for (const auto& p : r.envelope.points) {
    fmt::print(out, "{:>10.4g} {:>12.4g} {:>14.7g} {:>10.2g} {:>12.5g} {:>10.2g}\n",
               start_s + p.time_s, p.amplitude, p.frequency_hz.value, p.frequency_hz.std,
               p.damping_ratio.value, p.damping_ratio.std);
  }
  fmt::print(out, "frequency drift {:+.3g} Hz (std {:.2g})\n", r.envelope.frequency_drift_hz.value,
             r.envelope.frequency_drift_hz.std);
}

Json run(const DecayCommand& command, VerbContext& context) {
  signal::ReadOptions reading;
  reading.sample_rate_hz = command.sample_rate_hz;
  const auto recording = load_recording(command.file, context, reading);
  const auto& channel = chosen_channel(recording, command.channel);
  if (!(recording.sample_rate_hz > 0)) {
    throw UsageError(command.file + " gives no sample rate: say it with --sample-rate");
  }
  const double rate = recording.sample_rate_hz;
  const std::string where = command.file + ": " + channel.name;

  Json result;
  result["channel"] = channel.name;
  result["unit"] = channel.unit;
  result["sample_rate_hz"] = rate;
  if (recording.time_s.size() > 0) {
    context.refuse("not_uniform",
                   "samples are not evenly spaced in time; resample the recording first", where);
    result["modes"] = Json::array();
    return result;
  }
  signal::DecayOptions options;
  options.max_modes = command.max_modes;
  if (!command.band.empty()) {
    if (!(command.band[0] >= 0 && command.band[0] < command.band[1] &&
          command.band[0] < 0.5 * rate)) {
      throw UsageError(
          fmt::format("--band {} {} must rise and begin below half the sample rate, {} Hz",
                      command.band[0], command.band[1], 0.5 * rate));
    }
    options.band_low_hz = command.band[0], options.band_high_hz = command.band[1];
  }
  const Index from = command.start_s ? sample_at(recording, *command.start_s, true) : 0;
  const Index to =
      command.end_s ? sample_at(recording, *command.end_s, false) : recording.samples();
  if (from >= to || std::isnan(command.start_s.value_or(0)) ||
      std::isnan(command.end_s.value_or(0))) {
    throw UsageError(
        fmt::format("nothing between --start and --end: the record lasts from {} s to {} s",
                    recording.start_time_s, recording.start_time_s + recording.duration_s()));
  }
  if (command.start_s) options.choose_window = options.trim_start = false;

  const auto r = signal::estimate_decay(channel.samples.segment(from, to - from), rate, options);
  const double start_s = recording.start_time_s + static_cast<double>(from + r.start) / rate;
  const double end_s = recording.start_time_s + static_cast<double>(from + r.end - 1) / rate;
  result["window"] = {{"start_s", start_s}, {"end_s", end_s}, {"samples", r.end - r.start}};
  result["decays_found"] = r.decays.size();
  for (const auto& n : r.notes) context.warn(n.code, n.message, where);
  if (!r.refusal_code.empty()) {
    context.refuse(r.refusal_code, r.refusal, where);
    result["modes"] = Json::array();
    return result;
  }
  const double window_s = static_cast<double>(r.end - r.start) / rate;
  Json modes = Json::array(), tones = Json::array();
  for (const auto& mode : r.modes) modes.push_back(json_of(mode, window_s));
  for (const auto& tone : r.steady_tones) {
    tones.push_back(
        {{"frequency_hz", tone.damped_frequency_hz.value}, {"amplitude", tone.amplitude}});
  }
  result["modes"] = std::move(modes);
  result["frequency_drift_hz"] = json_number(r.envelope.frequency_drift_hz.value);
  result["frequency_drift_std_hz"] = json_number(r.envelope.frequency_drift_hz.std);
  result["amplitude_dependence"] = json_of(r.envelope, start_s);
  result["steady_tones"] = std::move(tones);
  result["noise_std"] = r.noise_std;
  result["signal_to_noise_db"] = r.signal_to_noise_db;
  result["residual_order"] = r.residual_order;
  result["degrees_of_freedom"] = r.degrees_of_freedom;
  print(command, channel, start_s, end_s, r, context.out);
  return result;
}

}  // namespace

void add_decay(CLI::App& program, Verbs& verbs) {
  auto command = std::make_shared<DecayCommand>();
  CLI::App* app = program.add_subcommand("decay", "Frequency and damping of a free decay");
  app->footer(kDecayExample);
  app->add_option("file", command->file, "Recording")->required()->type_name("FILE");
  app->add_option("--channel", command->channel,
                  "Name or #number; may be left out where there is one")
      ->type_name("C");
  app->add_option("--start", command->start_s, "Fit from this time on, s (default: found)")
      ->type_name("S");
  app->add_option("--end", command->end_s, "Use nothing after this time, s")->type_name("S");
  app->add_option("--band", command->band, "Report modes between these, Hz")
      ->expected(2)
      ->type_name("HZ");
  app->add_option("--max-modes", command->max_modes, "At most so many modes")
      ->check(CLI::Range(1, 12))
      ->capture_default_str();
  app->add_option("--sample-rate", command->sample_rate_hz, "Where the file gives none, Hz")
      ->check(positive_number())
      ->type_name("HZ");
  verbs.push_back({app, [command](VerbContext& context) { return run(*command, context); }});
}

}  // namespace rigfit::apps
