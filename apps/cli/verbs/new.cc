// rigfit new: a campaign to start from, of one's own recordings or as a commented example.
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include "apps/campaign_file/new/guess_campaign.h"
#include "apps/campaign_file/new/utility_line.h"
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
  UtilityLine line;
  std::vector<std::string> of_line;  ///< options given that are of a line
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

/// A line of poles and one of its poles without conductors.
TextFiles utility_line_files(const UtilityLine& line) {
  UtilityLine bare = line;
  bare.poles = 1;
  bare.conductors = 0;
  try {
    return {{"line.toml", utility_line_scene(line)}, {"pole.toml", utility_line_scene(bare)}};
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

Json run_new(VerbContext& context, const NewCommand& command) {
  if (command.example && !command.from.empty()) {
    throw UsageError("--example and --from: one of the two");
  }
  const bool line = command.guess.kind == "utility-line";
  if (line && (command.example || !command.from.empty())) {
    throw UsageError("--kind utility-line is a scene of its own: without --example and --from");
  }
  if (!line && !command.of_line.empty()) {
    throw UsageError(command.of_line.front() + " belongs to --kind utility-line");
  }
  const TextFiles texts = line ? utility_line_files(command.line) : files_of(command, context);
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
  context.out << fmt::format("next: rigfit {} {}\n", line ? "modes" : "report",
                             (root / texts.front().first).string());
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
      option("--kind", c.guess.kind,
             "What the recordings are [guessed], or a scene of utility poles")
          .one_of({"bending", "axial", "decay", "modal", "tension", "utility-line"})};
  for (auto& one :
       {option("--poles", c.line.poles, "Utility line: number of poles"),
        option("--height", c.line.height_m, "Of a pole above ground", "m"),
        option("--ground-diameter", c.line.ground_diameter_m, "", "m"),
        option("--top-diameter", c.line.top_diameter_m, "", "m"),
        option("--modulus", c.line.modulus_Pa, "", "Pa"),
        option("--density", c.line.density_kg_m3, "", "kg/m3"),
        option("--embedded", c.line.embedded_m,
               "m, on Winkler springs; 0: springs at the ground line"),
        option("--line-span", c.line.span_m, "", "m"),
        option("--conductors", c.line.conductors, "Of a span; 0: bare poles"),
        option("--conductor-tension", c.line.conductor_tension_N, "N, of one"),
        option("--zone-from", c.line.damage_from, "Zone of free EI: from, of the height"),
        option("--zone-to", c.line.damage_to, "Zone of free EI: to, of the height"),
        option("--damage", c.line.damage_depth, "Loss of EI in the zone of pole 1, 0..1")}) {
    options.push_back(describe::Option(one).tells(c.of_line));
  }
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
  Verb verb = verb_of<NewCommand>(
      "new", "Writes a campaign to start from: of one's own recordings, or a commented example",
      "Examples:\n"
      "  rigfit new my-rig --from hits/*.csv --unit CH8=V --sensitivity \"CH8=2.27 mV/N\"\n"
      "  rigfit new my-rig --example && rigfit report my-rig/campaign.toml",
      [](const NewCommand& c, VerbContext& context) { return run_new(context, c); });
  verb.reads = true;
  return verb;
}

}  // namespace rigfit::apps
