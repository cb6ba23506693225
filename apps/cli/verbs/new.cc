// rigfit new: a campaign to start from, of one's own recordings or as a commented example.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <tuple>
#include <utility>

#include "apps/campaign_file/bending_files.h"
#include "apps/campaign_file/recording_description.h"
#include "apps/cli/assets.h"
#include "apps/cli/at_hand.h"
#include "apps/cli/named_numbers.h"
#include "apps/cli/output_file.h"
#include "apps/cli/verbs/all.h"
#include "document/document_error.h"
#include "document/toml_table.h"
#include "signal/impact/pulse_shape.h"
#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/csv/frequency_table.h"
#include "signal/readers/files/mapped_file.h"
#include "signal/readers/files/read_formats.h"
#include "signal/readers/read_frfs.h"
#include "signal/recording/recording_error.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

/// What a person says that no file does.
struct GuessOptions {
  std::string kind;   ///< "bending", "axial", "decay", "modal", "tension"; empty: guessed
  std::string force;  ///< channel of the hammer; empty: guessed
  double span_m = 0, mass_kg = 0;  ///< bending and axial tests; 0: not given
  double mass_per_length = 0;      ///< kg/m, of tension tests; 0: not given
  /// Lengths in axial and tension tests, m: one for all files, one a file in their order, or
  /// "FILE=LENGTH".
  std::vector<std::string> lengths;
  std::map<std::string, std::string> units;          ///< by channel
  std::map<std::string, std::string> sensitivities;  ///< by channel, such as "2.27 mV/N"
};

struct GuessedCampaign {
  std::string text;                  ///< text of campaign.toml
  std::vector<std::string> remarks;  ///< what each file was taken for and why, for the terminal
};

using signal::lower_case;

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

/// Short pulses over a quiet record: the largest sample stands far above the root mean square.
bool has_pulses(const signal::Channel& channel) {
  Eigen::ArrayXd x = channel.samples.array();
  const auto last = std::remove_if(x.begin(), x.end(), [](double y) { return !std::isfinite(y); });
  x.conservativeResize(last - x.begin());
  if (x.size() < 64) return false;
  x -= x.mean();
  // A sine has a crest factor of 1.4, noise of 4 to 5, a decay that fills the record of some 5.
  const double rms = std::sqrt(x.square().mean());
  return rms > 0 && x.abs().maxCoeff() > 8 * rms;
}

/// Pulses to one side with rest between them, as a hammer's force: around the largest one, in
/// blocks down to a 64th of the record, since others may follow it.
bool looks_like_a_hammer(const signal::Channel& channel) {
  if (!has_pulses(channel)) return false;
  Eigen::Index peak = 0;
  channel.samples.unaryExpr([](double x) { return std::isfinite(x) ? std::abs(x) : 0.0; })
      .maxCoeff(&peak);
  const Eigen::Index samples = channel.samples.size();
  for (const Eigen::Index part : {1, 4, 16, 64}) {
    const Eigen::Index length = samples / part,
                       first = std::max<Eigen::Index>(0, peak - length / 10);
    if (length < 64) break;
    if (signal::pulse_shape(channel.samples, first, length).is_pulse()) return true;
  }
  return false;
}

struct Guess {
  std::string kind, why;
  std::string force;                   ///< modal
  std::vector<std::string> responses;  ///< modal, decay, axial, tension
  LoadDeflection bent;                 ///< bending
};

const signal::Channel* hammer_of(const signal::Recording& recording, const GuessOptions& options) {
  if (!options.force.empty()) {
    for (const auto& channel : recording.channels) {
      if (lower_case(channel.name) == lower_case(options.force)) return &channel;
    }
    return nullptr;
  }
  if (const auto* named = channel_like(recording, {"hammer", "impact"})) return named;
  for (const auto& channel : recording.channels) {
    if ((channel.quantity == signal::Quantity::force ||
         lower_case(channel.name).starts_with("force")) &&
        has_pulses(channel)) {
      return &channel;
    }
  }
  // Without a name: the one channel that looks like it and is no motion by its unit.
  const signal::Channel* found = nullptr;
  for (const auto& channel : recording.channels) {
    const bool could_be_force = channel.quantity == signal::Quantity::unknown ||
                                channel.quantity == signal::Quantity::voltage;
    if (!could_be_force || !looks_like_a_hammer(channel)) continue;
    if (found != nullptr) return nullptr;
    found = &channel;
  }
  return found;
}

Guess guess_of(const signal::Recording& recording, const GuessOptions& options) {
  Guess guess;
  guess.kind = options.kind;
  guess.why = "as said by --kind";
  const auto* const hammer = hammer_of(recording, options);
  const auto bent = load_deflection(recording);
  if (guess.kind.empty()) {
    if (bent && !bent->tension.empty()) {
      guess.kind = "bending";
      guess.why = "channels of tension, load and deflection";
    } else if (hammer != nullptr && recording.channels.size() > 1) {
      guess.kind = "modal";
      guess.why = "pulses of a hammer on channel " + hammer->name;
      if (hammer->quantity == signal::Quantity::voltage) {
        guess.why += fmt::format(", in V: say --sensitivity \"{}=X mV/N\"", hammer->name);
      }
    } else if (bent && lower_case(bent->deflection).starts_with("exten")) {
      throw signal::RecordingError(
          {.file = recording.path.string()}, "has load over extension: bent or pulled",
          "if a beam was bent, give it alone with --kind bending; if a cable was pulled, EA is its "
          "length times the slope that rigfit bending --span LENGTH --tension 0 prints");
    } else if (bent) {
      guess.kind = "bending";
      guess.why = "load over deflection, no tension; how it is held is assumed";
    } else {
      guess.kind = "decay";
      guess.why =
          "no hammer and no load-deflection pair: taken as free vibration; of a hung mass: give it "
          "to rigfit axial for EA";
    }
  }
  if (guess.kind == "bending") {
    if (!bent) {
      throw signal::RecordingError({.file = recording.path.string()},
                                   "has no load and deflection that belong together",
                                   "name its columns (tension, load, deflection) by a TOML file");
    }
    guess.bent = *bent;
    return guess;
  }
  if (recording.sample_rate_hz == 0) {
    throw signal::RecordingError(
        {.file = recording.path.string()}, "gives no sample rate",
        "if it is a recording, write sample_rate_hz = ... into a " +
            fs::path(recording.path).replace_extension(".toml").filename().string() + " beside it");
  }
  if (guess.kind == "modal") {
    if (hammer == nullptr) {
      throw signal::RecordingError({.file = recording.path.string()},
                                   "has no channel that looks like a hammer's",
                                   "say which it is: --force-channel C");
    }
    guess.force = hammer->name;
  }
  for (const auto& channel : recording.channels) {
    if (channel.name != guess.force) guess.responses.push_back(channel.name);
  }
  return guess;
}

std::string list_of(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + quoted(name);
  return "[" + text + "]";
}

/// What is said of this recording's channels, as keys of a `channel` table.
std::string channels_text(const signal::Recording& recording, const GuessOptions& options) {
  std::string text;
  for (const auto& channel : recording.channels) {
    std::string keys = "source = " + quoted(channel.name);
    const auto unit = options.units.find(channel.name);
    const auto sensitivity = options.sensitivities.find(channel.name);
    const char* comment = "  ";
    if (sensitivity != options.sensitivities.end()) {
      const std::size_t blank = sensitivity->second.find(' ');
      const std::string number = sensitivity->second.substr(0, blank);
      if (blank == std::string::npos || number.empty() ||
          number.find_first_not_of("+-.0123456789eE") != std::string::npos) {
        throw UsageError("--sensitivity " + channel.name + "=" + sensitivity->second +
                         ": write it with its unit, such as \"" + channel.name + "=2.27 mV/N\"");
      }
      keys += ", sensitivity = " + number +
              ", sensitivity_unit = " + quoted(sensitivity->second.substr(blank + 1));
    } else if (unit == options.units.end()) {
      if (!channel.unit.empty()) continue;
      comment = "  # the file gives no unit: ";
      keys += ", unit = \"m/s^2\"";
    }
    if (unit != options.units.end()) keys += ", unit = " + quoted(unit->second);
    text += comment + ("{ " + keys + " },\n");
  }
  return text.empty() ? text : "channel = [\n" + text + "]\n";
}

/// m, of a file; 0: none is given.
double length_of(const std::string& file, std::size_t place, std::size_t files,
                 const std::vector<std::string>& lengths) {
  double found = 0;
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    const bool named = lengths[k].find('=') != std::string::npos;
    if (!named && lengths.size() != 1 && lengths.size() != files) {
      throw UsageError(
          fmt::format("--length gives {} lengths for {} files: one for all, one each, "
                      "or FILE=METRES",
                      lengths.size(), files));
    }
    const auto given = named_numbers("--length", named ? lengths[k] : file + "=" + lengths[k],
                                     "metres, or FILE=METRES", 1, 1);
    const bool this_one = named ? given.name == file || given.name == fs::path(file).filename()
                                : lengths.size() == 1 || k == place;
    if (this_one) found = given.numbers[0];
  }
  return found;
}

/// Recordings of one test that share a length and what is said of their channels.
struct Group {
  double length_m = 0;
  std::string channels;
  std::vector<std::string> files;
};

struct Test {
  Guess guess;
  std::vector<Group> groups;
};

void need(bool given, const std::string& file, const char* what) {
  if (!given) throw UsageError(file + what);
}

/// The keys of a test; files are relative to the campaign.
std::string test_text(const std::string& name, const Test& test, const GuessOptions& options) {
  const Guess& guess = test.guess;
  const std::string& file = test.groups.front().files.front();
  std::string text =
      fmt::format("\n[[test]]\nname = \"{}\"\nkind = \"{}\"  # {}\n", name, guess.kind, guess.why);
  if (guess.kind == "bending") {
    need(options.span_m > 0, file,
         " is a bending test: give its span between the clamps, --span M");
    const bool tensioned = !guess.bent.tension.empty();
    text += fmt::format(
        "span = {}  # m, {}\n", options.span_m,
        tensioned ? "clamp to clamp" : "between clamps or supports; cantilever: to the load");
    if (!tensioned) {
      text +=
          "tension = 0\nends = \"clamped\"  # or \"pinned\" (on two supports), \"cantilever\"\n"
          "# rectangle = [0.02, 0.003]  # m, width and height: gives the modulus\n";
    }
    text += fmt::format("channels = {{ {}load = {}, deflection = {} }}\n",
                        tensioned ? "tension = " + quoted(guess.bent.tension) + ", " : "",
                        quoted(guess.bent.load), quoted(guess.bent.deflection));
  } else if (guess.kind == "axial") {
    need(options.mass_kg > 0, file, " is an axial test: give --mass KG");
    text += fmt::format("mass = {}  # kg, adapter included\n", options.mass_kg);
    if (!guess.responses.empty()) text += "channel = " + quoted(guess.responses.front()) + "\n";
  } else if (guess.kind == "tension") {
    need(options.mass_per_length > 0, file, " is a tension test: give --mass-per-length KG_M");
    text += fmt::format("length = {}  # m\nmass_per_length = {}  # kg/m\n",
                        test.groups.front().length_m, options.mass_per_length);
  } else if (guess.kind == "modal") {
    text += "force = " + quoted(guess.force) + "\nresponses = " + list_of(guess.responses) + "\n";
  }
  if (guess.kind == "decay" || guess.kind == "tension") {
    text += "channels = " + list_of(guess.responses) + "\n";
  }
  for (const auto& group : test.groups) {
    text += "[[test.recording]]\nfiles = " + list_of(group.files) + "\n";
    if (guess.kind == "axial") text += fmt::format("length = {}  # m of cable\n", group.length_m);
    text += group.channels;
  }
  return text;
}

/// Functions over frequency, which no campaign takes.
bool is_over_frequency(const std::string& file, VerbContext& context) {
  const signal::MappedFile mapped(file);
  return context.reading.format.empty() && !signal::foreign_format(mapped.bytes()) &&
         signal::frequency_table_in(mapped.bytes(), file, context.reading).has_value();
}

/// Files, and those in folders, which describe nothing and are none of ours.
std::vector<std::string> files_in(const std::vector<std::string>& given, const fs::path& folder) {
  std::vector<std::string> files;
  for (const auto& one : given) {
    std::error_code none;
    if (!fs::is_directory(one, none)) {
      if (fs::path(one).extension() != ".toml") files.push_back(one);
      continue;
    }
    std::vector<std::string> inside;
    for (const auto& entry : fs::recursive_directory_iterator(one, none)) {
      const auto& path = entry.path();
      const fs::path below = fs::absolute(path).lexically_normal().lexically_relative(
          fs::absolute(folder).lexically_normal());
      const bool ours = !below.string().starts_with("..");
      if (entry.is_regular_file(none) && path.extension() != ".toml" && !ours &&
          !path.filename().string().starts_with(".")) {
        inside.push_back(path.string());
      }
    }
    std::sort(inside.begin(), inside.end());
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

/// Options that no test of the campaign takes, and channels that no recording has.
void check_options(const std::string& text, const std::vector<std::string>& channels,
                   const GuessOptions& options) {
  for (const auto& [option, given, key] :
       {std::tuple{"--span", options.span_m > 0, "\nspan = "},
        std::tuple{"--mass", options.mass_kg > 0, "\nmass = "},
        std::tuple{"--mass-per-length", options.mass_per_length > 0, "\nmass_per_length = "},
        std::tuple{"--length", !options.lengths.empty(), "\nlength = "},
        std::tuple{"--force-channel", !options.force.empty(), "\nforce = "}}) {
    if (!given || text.find(key) != std::string::npos) continue;
    throw UsageError(
        fmt::format("{} belongs to none of these tests: give the files of such a test "
                    "alone, with --kind",
                    option));
  }
  for (const auto* map : {&options.units, &options.sensitivities}) {
    for (const auto& entry : *map) {
      if (std::find(channels.begin(), channels.end(), entry.first) == channels.end()) {
        throw UsageError("no recording has a channel \"" + entry.first + "\"");
      }
    }
  }
}

/// Reads the recordings (inputs and notes go to the context). A force channel with short pulses
/// makes hits; loads over deflections, with tension or without, a bending test; what is left a free
/// decay. Units and sensitivities stand in the campaign. What cannot be used is warned of
/// ("data_left_out"). Throws UsageError where a test needs a number that is not given or a number
/// is given that no test takes, signal::RecordingError where no file can be read.
GuessedCampaign guess_campaign(const fs::path& folder, const std::vector<std::string>& given,
                               const GuessOptions& options, VerbContext& context) {
  GuessedCampaign result;
  std::vector<Test> tests;
  std::vector<std::string> channels;
  const std::vector<std::string> files = files_in(given, folder);
  std::optional<signal::RecordingError> first_error;
  for (std::size_t place = 0; place < files.size(); ++place) {
    const auto& file = files[place];
    const auto leave_out = [&](const std::string& why) {
      context.warn("data_left_out", "is left out: " + why, file);
    };
    try {
      context.input(file);
      if (is_over_frequency(file, context)) {
        result.remarks.push_back(file + ": over frequency, left out; FRFs are for rigfit modal");
        continue;
      }
      signal::Recording recording = load_untold(file, context);
      for (const auto& channel : recording.channels) channels.push_back(channel.name);
      Group group;
      group.channels = channels_text(recording, options);
      auto said = document::TomlTable::parse(group.channels, file);
      signal::apply_description(signal::read_description(said), recording);
      Guess guess = guess_of(recording, options);
      if (guess.kind == "bending") drop_time_notes(recording);
      tell_notes(recording, context);
      if (guess.kind == "axial" || guess.kind == "tension") {
        group.length_m = length_of(file, place, files.size(), options.lengths);
        need(group.length_m > 0, file,
             ": give the length of cable, --length M (or --length FILE=M for each)");
      }
      result.remarks.push_back(fmt::format("{}: {} ({})", file, guess.kind, guess.why));
      std::error_code error;
      const fs::path relative = fs::proximate(fs::absolute(file), fs::absolute(folder), error);
      group.files = {error ? fs::absolute(file).string() : relative.string()};
      const auto same = std::find_if(tests.begin(), tests.end(), [&](const Test& test) {
        const bool one_cable = test.groups.front().length_m == group.length_m;
        return test.guess.kind == guess.kind && test.guess.force == guess.force &&
               test.guess.bent == guess.bent && test.guess.responses == guess.responses &&
               (guess.kind != "tension" || one_cable);
      });
      if (same == tests.end()) {
        tests.push_back({std::move(guess), {std::move(group)}});
        continue;
      }
      const auto as_before =
          std::find_if(same->groups.begin(), same->groups.end(), [&](const Group& one) {
            return one.length_m == group.length_m && one.channels == group.channels;
          });
      if (as_before == same->groups.end()) {
        same->groups.push_back(std::move(group));
      } else {
        as_before->files.push_back(group.files.front());
      }
    } catch (const signal::RecordingError& error) {
      if (!first_error) first_error = error;
      leave_out(error.what());
    } catch (const document::DocumentError& error) {
      leave_out(error.what());
    }
  }
  if (tests.empty() && first_error) throw *first_error;
  if (tests.empty()) throw UsageError("none of the files is a recording over time or a table");
  result.text =
      "# A campaign of your own recordings. Run it: rigfit report campaign.toml\n"
      "# Every key: rigfit help campaign. A commented example: rigfit new DIR --example\n\n"
      "title = " +
      quoted(fs::absolute(folder).lexically_normal().filename().string()) + "\n";
  std::map<std::string, int> count;
  for (const auto& test : tests) {
    const int number = ++count[test.guess.kind];
    result.text +=
        test_text(number == 1 ? test.guess.kind : fmt::format("{}-{}", test.guess.kind, number),
                  test, options);
  }
  check_options(result.text, channels, options);
  return result;
}

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
  for (const auto& text : given) result.insert(named_text(option, text, "CHANNEL=VALUE"));
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
      option("DIR", c.folder, "Folder to make").required(),
      option("--from", c.from, "Recordings, or folders of them, to make a campaign of"),
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
               "Of axial and tension tests, m: one for all, one a file, or FILE=M"),
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
