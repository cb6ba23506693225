// rigfit axial: EA, damping ratio and damper of a cable from hanging-mass records.

#include "apps/cli/verbs/all.h"
#include "ident/campaign/single_tests/axial_campaign.h"

namespace rigfit::apps {
namespace {

struct AxialCommand {
  std::vector<std::string> files;
  std::vector<double> lengths;  ///< m: one, one a file, or one a group of files
  AxialTest test;
};

constexpr const char* kAxialExample = R"(Example:
  rigfit axial a.csv b.csv c.csv --channel tension --mass 2.2 --mass-std 0.001 \
      --length 0.7 1.0 1.3 --length-std 0.001 --mass-per-length 0.16667
One length: for all files. As many lengths as files: one for each, in order. Otherwise the files are
taken in equal groups, one a length: six files with --length 0.7 1.0 are three of 0.7 m, then three
of 1.0 m. A file may hold several impulses; each is a sample. From two lengths on, a compliance in
series (frame, adapter) is told from the slope of 1/k over length. One length cannot tell: it gives
the stiffness of the whole chain and EA from below, unless --frame-stiffness says what the frame has
(rigid is a statement too).)";

std::vector<double> length_of_each_file(const AxialCommand& c) {
  const std::size_t files = c.files.size(), lengths = c.lengths.size();
  if (lengths == 0 || lengths > files || files % lengths != 0) {
    throw UsageError(
        fmt::format("{} files and {} lengths: give one length, one for each file, or one for "
                    "each group of files of equal size",
                    files, lengths));
  }
  std::vector<double> each;
  for (std::size_t i = 0; i < files; ++i) each.push_back(c.lengths[i / (files / lengths)]);
  return each;
}

Json run(AxialCommand& command, VerbContext& context) {
  const auto lengths = length_of_each_file(command);
  auto& inputs = command.test;
  inputs.threads = context.threads;
  for (std::size_t i = 0; i < command.files.size(); ++i) {
    signal::Recording recording = load_recording(command.files[i], context);
    (void)chosen_channel(recording, inputs.channel);
    inputs.recordings.push_back({recording.path.string(), std::move(recording), lengths[i]});
  }
  const auto result = ident::axial_campaign(inputs);
  context.tell(result.findings);
  if (context.plots) context.plots->add(axial_blocks("axial", result));
  if (result.test) describe::print(context.out, describe::sheet_of(*result.test));
  return axial_json(result);
}

describe::Options options_of(AxialCommand& c) {
  describe::Options options{
      option("FILE", c.files, "Recordings of the tension (or motion) after an impulse")
          .once()
          .required(),
      option("--length", c.lengths, "Cable length, m: for all, each file, or each group of files")
          .required()
          .positive()};
  for (auto& key : as_command_line(keys_of(c.test))) options.push_back(std::move(key));
  return options;
}

}  // namespace

Verb axial_verb() {
  return verb_of<AxialCommand>("axial", "EA and axial damping from hanging-mass records",
                               kAxialExample, run, true, true, []() -> Json {
                                 Json all = describe::schema_of<ident::AxialTestResult>();
                                 all["properties"]["samples"] =
                                     describe::schema_of<std::vector<ident::AxialRecord>>();
                                 return all;
                               });
}

}  // namespace rigfit::apps
