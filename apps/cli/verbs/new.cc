// rigfit new: a campaign to start from, of one's own recordings or as a commented example.
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <stdexcept>
#include <utility>

#include "apps/campaign_file/new/guess_campaign.h"
#include "apps/cli/assets.h"
#include "apps/cli/output_file.h"
#include "apps/cli/verbs/all.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

struct NewCommand {
  std::string folder;
  bool example = false;
  std::vector<std::string> from, units, sensitivities;
  GuessOptions guess;
};

/// "CH5=g" by channel.
std::map<std::string, std::string> by_channel(const std::vector<std::string>& given,
                                              const char* option) {
  std::map<std::string, std::string> result;
  for (const auto& text : given) {
    const std::size_t sign = text.find('=');
    if (sign == std::string::npos || sign == 0 || sign + 1 == text.size()) {
      throw UsageError(std::string(option) + " " + text + ": write it as CHANNEL=VALUE");
    }
    result[text.substr(0, sign)] = text.substr(sign + 1);
  }
  return result;
}

/// Name below the folder, content.
using TextFiles = std::vector<std::pair<std::string, std::string>>;

TextFiles files_of(const NewCommand& command, VerbContext& context) {
  if (command.from.empty()) {
    return {{"campaign.toml", std::string(assets::new_campaign_toml)},
            {"scenes/cable.toml", std::string(assets::new_cable_toml)},
            {"bending.csv", std::string(assets::new_bending_csv)},
            {"frequencies.csv", std::string(assets::new_frequencies_csv)}};
  }
  GuessOptions guess = command.guess;
  guess.units = by_channel(command.units, "--unit");
  guess.sensitivities = by_channel(command.sensitivities, "--sensitivity");
  const auto guessed = guess_campaign(command.folder, command.from, guess, context);
  for (const auto& remark : guessed.remarks) context.out << remark << '\n';
  return {{"campaign.toml", guessed.text}};
}

Json run(NewCommand& command, VerbContext& context) {
  if (command.example && !command.from.empty()) {
    throw UsageError("--example and --from: one of the two");
  }
  const TextFiles texts = files_of(command, context);
  const fs::path root = command.folder;
  for (const auto& text : texts) {
    std::error_code error;
    if (fs::exists(root / text.first, error)) {
      throw UsageError((root / text.first).string() + " exists already; name a folder of its own");
    }
  }
  Json files = Json::array();
  for (const auto& [name, content] : texts) {
    const fs::path path = root / name;
    make_output_folder(path.parent_path().empty() ? fs::path(".") : path.parent_path());
    write_whole_file(path, content);
    files.push_back(path.string());
    context.out << "wrote " << path.string() << '\n';
  }
  context.out << "next: rigfit report " << (root / texts.front().first).string() << '\n';
  return Json{{"files", std::move(files)}};
}

describe::Options options_of(NewCommand& c) {
  using describe::option;
  describe::Options options{
      option("folder", c.folder, "Folder to make").required().type("DIR"),
      option("--from", c.from, "Recordings, or folders of them, to make a campaign of")
          .type("FILES"),
      option("--example", c.example,
             "The commented example with published values (also without --from)"),
      option("--kind", c.guess.kind, "What the recordings are [guessed]")
          .one_of({"bending", "axial", "decay", "modal", "tension"})
          .needs("--from")};
  for (auto& one :
       {option("--force-channel", c.guess.force, "Channel of the hammer [guessed]"),
        option("--span", c.guess.span_m, "Of bending tests", "m").positive(),
        option("--mass", c.guess.mass_kg, "Of axial tests", "kg").positive(),
        option("--mass-per-length", c.guess.mass_per_length, "Of tension tests", "kg/m").positive(),
        option("--length", c.guess.lengths,
               "Of axial and tension tests, m: one for all, one a file, or FILE=M")
            .type("M"),
        option("--unit", c.units, "Unit of a channel that the files do not give")
            .type("CHANNEL=UNIT"),
        option("--sensitivity", c.sensitivities, "Of a channel's transducer")
            .type("\"CHANNEL=2.27 mV/N\"")}) {
    options.push_back(describe::Option(one).needs("--from"));
  }
  return options;
}

}  // namespace

Verb new_verb() {
  return verb_of<NewCommand>(
      "new", "Writes a campaign to start from: of one's own recordings, or a commented example",
      "Examples:\n"
      "  rigfit new my-rig --from hits/*.csv --unit CH8=V --sensitivity \"CH8=2.27 mV/N\"\n"
      "  rigfit new my-rig --example && rigfit report my-rig/campaign.toml",
      run, false, true);
}

}  // namespace rigfit::apps
