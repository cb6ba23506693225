// rigfit new: a campaign to start from, of one's own recordings or as a commented example.
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include "apps/campaign_file/new/guess_campaign.h"
#include "apps/campaign_file/new/new_campaign.h"
#include "apps/campaign_file/new/utility_line.h"
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

std::vector<TextFile> files_of(const NewCommand& command, VerbContext& context) {
  const fs::path root = command.folder;
  if (command.from.empty()) {
    std::vector<TextFile> files;
    for (const auto& [name, content] : new_campaign_files()) {
      files.push_back({root / name, std::string(content)});
    }
    return files;
  }
  GuessOptions guess = command.guess;
  guess.units = by_channel(command.units, "--unit");
  guess.sensitivities = by_channel(command.sensitivities, "--sensitivity");
  auto guessed = guess_campaign(root, command.from, guess, context);
  for (const auto& remark : guessed.remarks) context.out << remark << '\n';
  // A description that is there already stays, unless something new is said of the channels.
  std::erase_if(guessed.files, [&](const TextFile& file) {
    std::error_code error;
    if (file.path.filename() != "channels.toml" || !fs::exists(file.path, error)) return false;
    if (!guess.units.empty() || !guess.sensitivities.empty()) return false;
    context.out << file.path.string() << " exists and stays as it is\n";
    return true;
  });
  return guessed.files;
}

/// A line of poles and one of its poles without conductors.
Json new_utility_line(const fs::path& root, const UtilityLine& line, VerbContext& context) {
  UtilityLine bare = line;
  bare.poles = 1;
  bare.conductors = 0;
  Json files = Json::array();
  try {
    const std::pair<const char*, std::string> scenes[] = {{"line.toml", utility_line_scene(line)},
                                                          {"pole.toml", utility_line_scene(bare)}};
    for (const auto& [name, content] : scenes) {
      std::error_code error;
      if (fs::exists(root / name, error)) {
        throw UsageError((root / name).string() + " exists already; name a folder of its own");
      }
    }
    make_output_folder(root);
    for (const auto& [name, content] : scenes) {
      write_whole_file(root / name, content);
      files.push_back((root / name).string());
    }
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  context.out << fmt::format(
      "wrote {0}/line.toml and {0}/pole.toml\nnext: rigfit modes {0}/line.toml\n", root.string());
  return Json{{"files", std::move(files)}};
}

/// Options of the template; lengths in m, Pa, kg/m3, N.
Json run_new(VerbContext& context, const NewCommand& command) {
  if (command.example && !command.from.empty()) {
    throw UsageError("--example and --from: one of the two");
  }
  if (command.guess.kind == "utility-line") {
    if (command.example || !command.from.empty()) {
      throw UsageError("--kind utility-line is a scene of its own: without --example and --from");
    }
    return new_utility_line(command.folder, command.line, context);
  }
  const std::vector<TextFile> texts = files_of(command, context);
  for (const auto& text : texts) {
    std::error_code error;
    if (fs::exists(text.path, error)) {
      throw UsageError(text.path.string() + " exists already; " +
                       (text.path.filename() == "channels.toml"
                            ? "write units and sensitivities into it"
                            : "name a folder of its own"));
    }
  }
  Json files = Json::array();
  for (const auto& text : texts) {
    if (!text.path.parent_path().empty()) make_output_folder(text.path.parent_path());
    write_whole_file(text.path, text.content);
    files.push_back(text.path.string());
  }
  const fs::path root = command.folder;
  context.out << fmt::format("wrote {}\nnext: rigfit report {} --out {}\n",
                             (root / "campaign.toml").string(), (root / "campaign.toml").string(),
                             (root / "report").string());
  return Json{{"files", std::move(files)}};
}

describe::Options options_of(NewCommand& c) {
  using describe::option;
  return {option("folder", c.folder, "Folder to make").required().type("DIR"),
          option("--from", c.from, "Recordings to make a campaign of").type("FILES"),
          option("--example", c.example,
                 "The commented example with published values (also without --from)"),
          option("--kind", c.guess.kind,
                 "What the recordings are [guessed], or a scene of utility poles")
              .one_of({"bending", "axial", "decay", "modal", "utility-line"}),
          option("--poles", c.line.poles, "Utility line: number of poles"),
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
          option("--damage", c.line.damage_depth, "Loss of EI in the zone of pole 1, 0..1"),
          option("--force-channel", c.guess.force, "Channel of the hammer [guessed]"),
          option("--span", c.guess.span_m, "Of bending tests", "m").positive(),
          option("--mass", c.guess.mass_kg, "Of axial tests", "kg").positive(),
          option("--length", c.guess.length_m, "Of axial tests", "m").positive(),
          option("--unit", c.units, "Unit of a channel that the files do not give")
              .type("CHANNEL=UNIT"),
          option("--sensitivity", c.sensitivities, "Of a channel's transducer")
              .type("\"CHANNEL=2.27 mV/N\"")};
}
}  // namespace

Verb new_verb() {
  Verb verb = verb_of<NewCommand>(
      "new", "Writes a campaign to start from: of one's own recordings, or a commented example",
      "Examples:\n"
      "  rigfit new my-rig --from hits/*.csv --sensitivity \"CH8=2.27 mV/N\" --unit CH2=g\n"
      "  rigfit new my-rig --example && rigfit report my-rig/campaign.toml --out report",
      [](const NewCommand& c, VerbContext& context) { return run_new(context, c); });
  verb.reads = true;
  return verb;
}

}  // namespace rigfit::apps
