// rigfit inspect: what recordings hold and whether they are fit for use.

#include "apps/campaign_file/bending_files.h"
#include "apps/cli/verbs/all.h"
#include "signal/quality/quality.h"
#include "signal/readers/read_recording.h"

namespace rigfit::apps {
namespace {

struct InspectCommand {
  std::vector<std::string> files;
};

constexpr const char* kInspectExample = R"(Example:
  rigfit inspect hits.csv
  rigfit inspect --json report.json hits.csv decay.uff run.lvm
A file without times needs its rate:
  rigfit inspect --sample-rate 500 force.csv
A TOML file beside a recording (hits.csv -> hits.toml) names, scales and orients its channels.)";

signal::Recording load(const std::string& path, VerbContext& context) {
  signal::Recording recording = load_untold(path, context);
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

/// One entry of `recordings[]`.
Json inspected(const signal::Recording& recording, VerbContext& context) {
  const std::string path = recording.path.string();
  const auto channels = signal::check_quality(recording);
  for (const auto& channel : channels) {
    for (const auto& finding : channel.findings) {
      context.warn(finding.code, finding.message, path + ": " + channel.channel->name);
    }
  }
  if (context.plots) {
    const auto id = fmt::format("recording-{}", context.plots->blocks.size() + 1);
    context.plots->add(recording_plots(id, recording, channels));
  }
  auto& out = context.out;
  out << fmt::format("{} ({}): {} samples", path, recording.format, recording.samples());
  if (recording.sample_rate_hz > 0) {
    out << fmt::format(" at {:.9g} Hz, {:.6g} s", recording.sample_rate_hz, recording.duration_s());
  }
  out << '\n';
  describe::print(out, describe::table_of(channels));
  Json result = describe::json_of(recording);
  result["channels"] = describe::json_of(channels);
  return result;
}

Json run(InspectCommand& options, VerbContext& context) {
  return {{"recordings", describe::json_list(options.files, [&](const auto& path) {
             return inspected(load(path, context), context);
           })}};
}

describe::Options options_of(InspectCommand& c) {
  return {option("FILE", c.files,
                 "Recordings: CSV and other tables of text, UFF 58, LabVIEW .lvm, WAV, MATLAB "
                 ".mat, NumPy .npy")
              .once()
              .required()};
}

}  // namespace

Verb inspect_verb() {
  return verb_of<InspectCommand>(
      "inspect",
      "Read recordings and check their quality: rate, channels, units, clipping, "
      "dropouts, missing samples, quantisation",
      kInspectExample, run, true, true, []() -> Json {
        Json one = describe::schema_of<signal::Recording>();
        one["properties"]["channels"] = describe::schema_of<std::vector<signal::ChannelQuality>>();
        return describe::schema_of_keys(
            {{"recordings", {{"type", "array"}, {"items", std::move(one)}}}});
      });
}

}  // namespace rigfit::apps
