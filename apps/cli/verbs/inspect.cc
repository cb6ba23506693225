// rigfit inspect: what recordings hold and whether they are fit for use.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "apps/campaign_file/bending_files.h"
#include "apps/campaign_file/recording_description.h"
#include "apps/cli/at_hand.h"
#include "apps/cli/plots/plot_option.h"
#include "apps/cli/verbs/all.h"
#include "apps/report/figures/figures.h"
#include "signal/quality/quality.h"
#include "signal/readers/csv/frequency_table.h"
#include "signal/readers/files/foreign_formats.h"
#include "signal/readers/files/mapped_file.h"
#include "signal/readers/read_frfs.h"
#include "signal/readers/read_recording.h"
#include "signal/readers/uff/read_uff.h"

namespace rigfit::apps {
namespace {

struct InspectCommand {
  std::vector<std::string> files;
  double sample_rate_hz = 0;
};

constexpr std::size_t kMostDrawn = 20;  // recordings, so that a page opens at once

constexpr const char* kInspectExample = R"(Example:
  rigfit inspect hits.csv
  rigfit inspect --json report.json hits.csv decay.uff run.lvm
A file without times needs its rate:
  rigfit inspect --sample-rate 500 force.csv
A TOML file beside a recording (hits.csv -> hits.toml) names, scales and orients its channels.)";

/// A table over frequency as functions to look at; empty: the file is none.
std::optional<signal::FrequencyTable> frequency_table(const std::string& path,
                                                      std::string_view bytes,
                                                      VerbContext& context) {
  if (!context.reading.format.empty() || signal::foreign_format(bytes)) return std::nullopt;
  return signal::frequency_table_in(bytes, path, context.reading);
}

signal::Recording functions_of(const signal::FrequencyTable& table, VerbContext& context) {
  signal::Recording functions;
  functions.path = table.path;
  functions.format = "csv";
  functions.channels = table.functions;
  functions.notes = table.notes;
  const auto& f = table.frequency_hz;
  functions.notes.push_back(
      {"not_a_time_history",
       fmt::format("{} over frequency, {:.6g} to {:.6g} Hz in {} lines{}",
                   signal::holds_frfs(table) ? "FRFs" : "a spectrum", f[0], f[f.size() - 1],
                   f.size(), signal::holds_frfs(table) ? "; rigfit modal finds modes in them" : ""),
       ""});
  tell_notes(functions, context);
  return functions;
}

/// What the file holds: a recording, or functions that are not over time.
signal::Recording load(const std::string& path, VerbContext& context, double rate) {
  if (!recording_at_hand(path, context)) {
    const signal::MappedFile file(path);
    if (context.reading.format.empty() &&
        signal::format_of(file.bytes()) == signal::RecordingFormat::uff) {
      signal::Recording functions = signal::read_uff_functions(file.bytes(), path);
      bool over_time = true;
      for (const auto& note : functions.notes) over_time &= note.code != "not_a_time_history";
      if (!over_time) {
        tell_notes(functions, context);
        return functions;
      }
    }
  }
  signal::ReadOptions options;
  options.sample_rate_hz = rate;
  signal::Recording recording = load_untold(path, context, options);
  if (const auto table = load_deflection(recording); table && recording.sample_rate_hz == 0) {
    drop_time_notes(recording);
    recording.notes.push_back(
        {"load_deflection_table",
         fmt::format(
             "has no times and is a load-deflection table (load \"{}\", deflection \"{}\"{}): "
             "give it to rigfit bending if a cable or a beam was bent",
             table->load, table->deflection,
             table->tension.empty() ? ", no tension: --tension 0"
                                    : ", tension \"" + table->tension + "\""),
         ""});
  }
  tell_notes(recording, context);
  return recording;
}

Json json_of(const signal::Recording& recording, const signal::QualityResult& quality) {
  Json out;
  out["path"] = recording.path.string();
  out["format"] = recording.format;
  out["sample_rate_hz"] =
      recording.sample_rate_hz > 0 ? Json(recording.sample_rate_hz) : Json(nullptr);
  out["sample_rate_relative_std"] = recording.sample_rate_relative_std;
  out["samples"] = recording.samples();
  out["duration_s"] = recording.sample_rate_hz > 0 ? Json(recording.duration_s()) : Json(nullptr);
  out["start_time_s"] = recording.start_time_s;
  out["time_jitter_s"] = recording.time_jitter_s;
  out["uniform"] = recording.time_s.size() == 0;
  Json channels = Json::array();
  for (std::size_t k = 0; k < recording.channels.size(); ++k) {
    const auto& channel = recording.channels[k];
    const auto& q = quality.channels[k];
    Json entry;
    entry["name"] = channel.name;
    entry["unit"] = channel.unit;
    entry["source_unit"] = channel.source_unit;
    entry["quantity"] = signal::name_of(channel.quantity);
    entry["min"] = q.min;
    entry["max"] = q.max;
    entry["mean"] = q.mean;
    entry["rms"] = q.rms;
    entry["clipped_samples"] = q.clipped_samples;
    entry["missing_samples"] = q.missing_samples;
    entry["stuck_samples"] = q.stuck_samples;
    entry["nominal_range"] =
        channel.nominal_range > 0 ? Json(channel.nominal_range) : Json(nullptr);
    entry["quantum"] = q.quantum;
    entry["noise_floor"] = q.noise_floor;
    entry["drift"] = q.drift;
    entry["mains_hz"] = q.mains_hz > 0 ? Json(q.mains_hz) : Json(nullptr);
    entry["mains_rms"] = q.mains_rms;
    entry["findings"] = Json::array();
    for (const auto& finding : q.findings) {
      entry["findings"].push_back(
          {{"code", finding.code}, {"message", finding.message}, {"samples", finding.samples}});
    }
    channels.push_back(std::move(entry));
  }
  out["channels"] = std::move(channels);
  return out;
}

std::string clipped_text(const std::string& text, std::size_t width) {
  std::size_t columns = 0, at = 0;
  while (at < text.size() && columns < width) {
    ++at;
    while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80) ++at;
    ++columns;
  }
  return text.substr(0, at) + std::string(width - columns, ' ');
}

void print(std::ostream& out, const signal::Recording& recording,
           const signal::QualityResult& quality) {
  out << fmt::format("{} ({}): {} samples", recording.path.string(), recording.format,
                     recording.samples());
  if (recording.sample_rate_hz > 0) {
    out << fmt::format(" at {:.9g} Hz, {:.6g} s", recording.sample_rate_hz, recording.duration_s());
  }
  out << fmt::format("\n  {} {:<8} {:>11} {:>11} {:>11} {:>11} {:>7} {:>7}\n",
                     clipped_text("channel", 20), "unit", "min", "max", "mean", "rms", "clipped",
                     "missing");
  for (std::size_t k = 0; k < recording.channels.size(); ++k) {
    const auto& channel = recording.channels[k];
    const auto& q = quality.channels[k];
    out << fmt::format("  {} {:<8} {:>11.4g} {:>11.4g} {:>11.4g} {:>11.4g} {:>7} {:>7}\n",
                       clipped_text(channel.name, 20), channel.unit.empty() ? "-" : channel.unit,
                       q.min, q.max, q.mean, q.rms, q.clipped_samples, q.missing_samples);
  }
}

/// One entry of `recordings[]`.
Json inspect_result(const signal::Recording& recording, VerbContext& context) {
  const signal::QualityResult quality = signal::check_quality(recording);
  const bool over_time =
      std::none_of(recording.notes.begin(), recording.notes.end(),
                   [](const auto& note) { return note.code == "not_a_time_history"; });
  for (const auto& channel : quality.channels) {
    for (const auto& finding : channel.findings) {
      // Spectra neither drift nor clip; what is missing there is missing all the same.
      if (!over_time && finding.code != "missing") continue;
      context.warn(finding.code, finding.message, recording.path.string() + ": " + channel.channel);
    }
  }
  print(context.out, recording, quality);
  if (context.plots && context.plots->sources++ < kMostDrawn) {
    const auto id = fmt::format("recording-{}", context.plots->blocks.size() + 1);
    context.plots->add(recording_plots(id, recording, quality));
  }
  return json_of(recording, quality);
}

/// The entry of a file, which may hold functions that are not over time.
Json inspect_file(const std::string& path, double sample_rate_hz, VerbContext& context) {
  std::optional<signal::FrequencyTable> spectrum;
  if (!recording_at_hand(path, context)) {
    context.input(path);
    const signal::MappedFile file(path);
    spectrum = frequency_table(path, file.bytes(), context);
  }
  if (!spectrum) return inspect_result(load(path, context, sample_rate_hz), context);
  Json entry = inspect_result(functions_of(*spectrum, context), context);
  const auto& f = spectrum->frequency_hz;
  entry["frequency_hz"] = {{"first", f[0]}, {"last", f[f.size() - 1]}, {"lines", f.size()}};
  return entry;
}

Json inspect(const InspectCommand& options, VerbContext& context) {
  Json result;
  result["recordings"] = Json::array();
  for (const auto& path : options.files) {
    result["recordings"].push_back(inspect_file(path, options.sample_rate_hz, context));
  }
  if (context.plots && options.files.size() > kMostDrawn) {
    context.warn("left_out", fmt::format("the first {} of {} recordings are drawn", kMostDrawn,
                                         options.files.size()));
  }
  return result;
}

describe::Options options_of(InspectCommand& c) {
  using describe::option;
  return {option("FILE", c.files,
                 "Recordings: CSV and other tables of text, UFF 58, LabVIEW .lvm, WAV, MATLAB "
                 ".mat, NumPy .npy, Excel .xlsx; spectra and FRFs as tables")
              .required(),
          option("--sample-rate", c.sample_rate_hz, "Sample rate in Hz of files that give none")
              .positive()
              .type("HZ")};
}

}  // namespace

Verb inspect_verb() {
  Verb verb = verb_of<InspectCommand>(
      "inspect",
      "Read recordings and check their quality: rate, channels, units, clipping, "
      "dropouts, missing samples, offset, drift, noise, hum, quantisation",
      kInspectExample,
      [](const InspectCommand& c, VerbContext& context) { return inspect(c, context); });
  verb.draws = true;
  verb.reads = true;
  return verb;
}

}  // namespace rigfit::apps
