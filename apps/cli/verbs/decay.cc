// rigfit decay: frequency and damping of a free decay, with what the decay looks like.
#include "ident/campaign/single_tests/decay_campaign.h"

#include "apps/cli/verbs/all.h"

namespace rigfit::apps {
namespace {

struct DecayCommand {
  std::string file, channel;  ///< name or "#number"; may be empty where there is one
  ident::DecayTestOptions options;
};

constexpr const char* kDecayExample = R"(Example:
  rigfit decay tap.csv --channel tension
  rigfit decay swing.csv --channel gyro --start 1.5 --end 20 --band 0.4 1 --json -
  rigfit decay taps.csv --channel tension --each
Times are those of the file. Without --start the decay is looked for: after an impact, after
clipped samples, up to the next impact. All decays of the record are listed, the strongest is
fitted; with --each every one is, and their modes are pooled. Frequencies are undamped natural ones,
f sqrt(1 - zeta^2) is given as damped_frequency_hz. With --band, decays are looked for in the band;
modes outside are fitted but not reported.)";

Json run(DecayCommand& command, VerbContext& context) {
  const signal::Recording recording = load_recording(command.file, context);
  command.file = recording.path.string();
  const auto& channel = chosen_channel(recording, command.channel);
  ident::TestRecording one{command.file, recording};
  one.recording.channels = {channel};
  const auto test = ident::run_decay_test(one, command.options);
  context.tell(test.findings);
  if (test.channels.empty()) return {{"channel", channel.name}, {"modes", Json::array()}};
  const auto& found = test.channels.front();
  if (context.plots) {
    context.plots->add(decay_plot("decay", found));
    context.plots->add(damping_plot("damping", {found}));
  }
  if (found.result.refusal_code.empty()) {
    context.out << fmt::format("{}: channel {}{}, fitted from {:.6g} s to {:.6g} s\n", command.file,
                               channel.name, channel.unit.empty() ? "" : " in " + channel.unit,
                               found.start_s, found.end_s);
    describe::print(context.out, describe::sheet_of(found));
  }
  Json result = describe::json_of(found);
  result["window"] = {{"start_s", result["start_s"]}, {"end_s", result["end_s"]}};
  return result;
}

describe::Options options_of(DecayCommand& c) {
  return {
      option("file", c.file, "Recording").required(),
      option("--channel", c.channel, "Name or #number; may be left out where there is one"),
      option("--start", c.options.start_s, "Fit from this time on, s (default: found)"),
      option("--end", c.options.end_s, "Use nothing after this time", "s"),
      band("--band", c.options.decay.band_low_hz, c.options.decay.band_high_hz,
           "Report modes between these"),
      option(
          "--each", c.options.each,
          "Fit every decay of the record and pool their modes: mean, and scatter between decays")};
}

}  // namespace

Verb decay_verb() {
  return verb_of<DecayCommand>("decay", "Frequency and damping of a free decay", kDecayExample, run,
                               true, true, describe::schema_of<ident::ChannelDecays>);
}

}  // namespace rigfit::apps
