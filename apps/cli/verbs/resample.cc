// rigfit resample: a recording at another rate, or at an even one.
#include <fmt/format.h>

#include <memory>

#include "apps/campaign_file/recording_description.h"
#include "apps/cli/number_checks.h"
#include "apps/cli/verbs/all.h"
#include "apps/cli/verbs/calls.h"
#include "signal/writers/write_csv.h"

namespace rigfit::apps {

Json resample_result(const signal::Recording& recording, const ResampleCommand& command,
                     VerbContext& context, signal::ResampleResult& result) {
  const std::size_t known = recording.notes.size();
  result = signal::resampled(recording, command.rate_hz);
  for (std::size_t k = known; k < result.recording.notes.size(); ++k) {
    context.out << result.recording.notes[k].message << '\n';
  }
  Json channels = Json::array();
  for (std::size_t c = 0; c < result.error_rms.size(); ++c) {
    const auto& channel = result.recording.channels[c];
    channels.push_back(
        {{"name", channel.name}, {"unit", channel.unit}, {"error_rms", result.error_rms[c]}});
    context.out << fmt::format("{}: error at most {:.2g} {} rms\n", channel.name,
                               result.error_rms[c], channel.unit);
  }
  Json json{{"from_hz", result.from_hz},
            {"sample_rate_hz", result.recording.sample_rate_hz},
            {"samples", result.recording.samples()},
            {"channels", std::move(channels)}};
  if (command.out.empty()) return json;
  // Nine digits: rounding stays below the filter's error.
  context.write(command.out, signal::csv_text(result.recording, {}, 9));
  context.out << fmt::format("{} samples at {:.9g} Hz: {}\n", result.recording.samples(),
                             result.recording.sample_rate_hz, command.out);
  json["out"] = command.out;
  return json;
}

void add_resample(CLI::App& program, Verbs& verbs) {
  const auto command = std::make_shared<ResampleCommand>();
  CLI::App* app = program.add_subcommand(
      "resample", "A recording at another rate (with a filter), or uneven times made even");
  app->add_option("FILE", command->file, "Recording")->required();
  app->add_option("--rate", command->rate_hz,
                  "New rate, Hz [of uneven times that of their usual step]")
      ->check(positive_number())
      ->type_name("HZ");
  app->add_option("--sample-rate", command->sample_rate_hz, "Where the file gives none, Hz")
      ->check(positive_number())
      ->type_name("HZ");
  app->add_option("--out", command->out, "Recording to write")->required()->type_name("F.csv");
  app->footer(
      "Example:\n  rigfit resample uneven.csv --out even.csv\n"
      "  rigfit resample fast.wav --rate 4000 --out slow.csv");
  verbs.push_back({app, [command](VerbContext& context) {
                     signal::ReadOptions reading;
                     reading.sample_rate_hz = command->sample_rate_hz;
                     signal::ResampleResult result;
                     return resample_result(load_recording(command->file, context, reading),
                                            *command, context, result);
                   }});
}

}  // namespace rigfit::apps
