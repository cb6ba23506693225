// rigfit resample: a recording at another rate, or at an even one.

#include "signal/recording/resample.h"
#include "apps/cli/verbs/all.h"
#include "signal/writers/writers.h"

namespace rigfit::apps {
namespace {

struct ResampleCommand {
  std::string file, out;
  double rate_hz = 0;  ///< 0: of uneven times that of their usual step
};

Json run(ResampleCommand& command, VerbContext& context) {
  const signal::Recording recording = load_recording(command.file, context);
  signal::ResampleResult result = signal::resampled(recording, command.rate_hz);
  Json json = describe::json_of(result);
  if (context.at_hand) {
    context.at_hand->resampled = std::make_shared<signal::Recording>(result.recording);
  }
  result.recording.notes.erase(result.recording.notes.begin(),
                               result.recording.notes.begin() + std::ssize(recording.notes));
  tell_notes(result.recording, context);  // without those told when it was read
  describe::print(context.out, describe::sheet_of(result));
  // Nine digits: rounding stays below the filter's error.
  const auto csv = [&] { return signal::csv_text(result.recording, {}, 9); };
  write_result(command.out, csv, "recording", "out", json, context);
  return json;
}

describe::Options options_of(ResampleCommand& c) {
  return {option("FILE", c.file, "Recording").required(),
          option("--rate", c.rate_hz, "New rate, Hz [of uneven times that of their usual step]")
              .positive(),
          option("--out", c.out, "Recording to write").writes().required()};
}

}  // namespace

Verb resample_verb() {
  return verb_of<ResampleCommand>(
      "resample", "A recording at another rate (with a filter), or uneven times made even",
      "Example:\n  rigfit resample uneven.csv --out even.csv\n"
      "  rigfit resample fast.wav --rate 4000 --out slow.csv",
      run, false, true, describe::schema_of<signal::ResampleResult>);
}

}  // namespace rigfit::apps
