// rigfit new: a campaign to start from, of one's own recordings or as a commented example.

#include <exception>
#include <system_error>

#include "apps/campaign_file/bending_files.h"
#include "apps/cli/assets.h"
#include "apps/cli/verbs/all.h"
#include "signal/ambient/ambient_modes.h"
#include "signal/decay/decay.h"
#include "signal/readers/csv_fields.h"
#include "signal/recording/recording.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

/// A number that tests of these kinds need and no file tells.
struct Needed {
  const char *key, *kinds, *unit;
};
constexpr Needed kNeeded[] = {{"span", "bending", "m between the clamps or supports"},
                              {"length", "axial, tension", "m of cable"},
                              {"mass", "axial", "kg, adapter included"},
                              {"mass_per_length", "tension", "kg/m"}};

struct NewCommand {
  std::string folder;
  bool example = false;
  std::vector<std::string> from;
  std::string kind;                                                     ///< empty: guessed
  std::map<std::string, double> numbers;                                ///< by key; 0: not given
  std::map<std::string, std::pair<double, std::string>> sensitivities;  ///< by channel, with unit
};

/// "CHANNEL=2.27 mV/N"
void add_sensitivity(const std::string& text, NewCommand& command) {
  const auto [name, value] = named_text("--sensitivity", text, "\"CHANNEL=2.27 mV/N\"");
  const auto blank = std::min(value.find(' '), value.size());
  double number = 0;
  if (!signal::parse_whole_number(value.substr(0, blank), '.', number) || blank == value.size()) {
    throw UsageError("--sensitivity " + text + ": write it with its unit, \"CHANNEL=2.27 mV/N\"");
  }
  command.sensitivities[name] = {number, value.substr(blank + 1)};
}

/// A test of the campaign: files that agree in its keys.
struct GuessedTest {
  std::string kind, why, keys;
  std::map<std::string, std::vector<std::string>> recordings;  ///< files by their own keys
};

/// A text or a list of texts: JSON writes them as TOML does.
std::string toml_text(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Short pulses to one side over a quiet record: the largest sample stands far above the root mean
/// square (a sine has a crest factor of 1.4, noise of 4 to 5, a decay that fills the record of some
/// 5); a response goes to both sides.
bool has_pulses(const Eigen::VectorXd& samples) {
  Eigen::ArrayXd x = samples.unaryExpr([](double y) { return std::isfinite(y) ? y : 0.0; });
  if (x.size() < 64) return false;
  x -= x.mean();
  const double up = x.maxCoeff(), down = -x.minCoeff(), rms = std::sqrt(x.square().mean());
  return std::max(up, down) > 8 * rms && std::min(up, down) < 0.2 * std::max(up, down);
}

/// The channel of the hammer: by its name, or as the only one, a force before others, that has its
/// pulses and is no motion by its unit; null: there is none.
const signal::Channel* hammer_of(const signal::Recording& recording) {
  if (const auto* named = channel_like(recording, {"hammer", "impact"})) return named;
  using enum signal::Quantity;
  for (const auto& wanted : {std::vector{force}, {unknown, voltage}}) {
    std::vector<const signal::Channel*> alike;
    for (const auto& channel : recording.channels) {
      const bool could_be = std::ranges::find(wanted, channel.quantity) != wanted.end();
      if (could_be && has_pulses(channel.samples)) alike.push_back(&channel);
    }
    if (alike.size() == 1) return alike.front();
  }
  return nullptr;
}

signal::RecordingError unusable(const signal::Recording& recording, const char* problem,
                                const std::string& remedy) {
  return {{.file = recording.path.string()}, problem, remedy};
}

/// Whether half of the channels or more show no decay, and all together modes of a motion that
/// lasts: one decay is over in two of the groups that a sure mode's energy is in, degrees = 1.
bool is_ambient(const signal::Recording& recording) try {
  const double rate_hz = recording.sample_rate_hz;
  const auto refused = std::ranges::count_if(recording.channels, [&](const auto& channel) {
    return rate_hz > 0 && !signal::estimate_decay(channel.samples, rate_hz).refusal_code.empty();
  });
  if (2 * refused < std::ssize(recording.channels)) return false;
  return std::ranges::any_of(signal::ambient_modes(recording).modes,
                             [](const auto& one) { return !one.mode.doubtful && one.degrees > 1; });
} catch (const signal::RecordingError&) {  // too short, or a channel that does not move
  return false;
}

/// Kind of the test that a recording is of, and why it is taken for that.
std::pair<std::string, std::string> kind_of(const signal::Recording& recording,
                                            const NewCommand& command,
                                            const signal::Channel* hammer,
                                            const std::optional<LoadDeflection>& bent) {
  if (!command.kind.empty()) return {command.kind, "as said by --kind"};
  if (bent && !bent->tension.empty()) {
    return {"bending", "channels of tension, load and deflection"};
  }
  if (hammer != nullptr && recording.channels.size() > 1) {
    const bool volts = hammer->quantity == signal::Quantity::voltage;
    return {"modal",
            "pulses of a hammer on channel " + hammer->name +
                (volts ? fmt::format(", in V: say --sensitivity \"{}=X mV/N\"", hammer->name)
                       : std::string())};
  }
  if (bent) {
    return {"bending",
            "load over deflection, no tension; how it is held is assumed; of a pulled cable EA is "
            "the slope times the length"};
  }
  if (is_ambient(recording)) return {"modal", "no hammer, no decay, but modes: ambient motion"};
  return {"decay",
          "no hammer and no load-deflection pair: taken as free vibration; of a hung mass: give it "
          "to rigfit axial for EA; of motion in the wind: kind = \"modal\", ambient = true"};
}

/// The channels of a test, as keys; `said`: its kind is not guessed.
std::string channel_keys(const std::string& kind, bool said, const signal::Recording& recording,
                         const signal::Channel* hammer, const std::optional<LoadDeflection>& bent) {
  if (kind == "bending" && !bent) {
    throw unusable(recording, "has no load and deflection that belong together",
                   "name its columns (tension, load, deflection) by a TOML file");
  }
  if (kind == "bending") {
    const bool beam = bent->tension.empty();
    return fmt::format(
        "{}channels = {{ {}load = {}, deflection = {} }}\n",
        beam ? "tension = 0\nends = \"clamped\"  # or \"pinned\" (on two supports), "
               "\"cantilever\"\n# rectangle = [0.02, 0.003]  # m, width and height: gives the "
               "modulus\n"
             : "",
        beam ? "" : "tension = " + toml_text(bent->tension) + ", ", toml_text(bent->load),
        toml_text(bent->deflection));
  }
  if (recording.sample_rate_hz == 0) {
    throw unusable(recording, "gives no sample rate",
                   "if it is a recording, write sample_rate_hz = ... into a " +
                       fs::path(recording.path).replace_extension(".toml").filename().string() +
                       " beside it");
  }
  std::vector<std::string> names;
  for (const auto& channel : recording.channels) {
    if (kind != "modal" || &channel != hammer) names.push_back(channel.name);
  }
  if (kind == "axial") return "channel = " + toml_text(names.front()) + "\n";
  if (kind != "modal") return "channels = " + toml_text(names) + "\n";
  if (hammer == nullptr && said) {
    throw unusable(recording, "has no channel that looks like a hammer's",
                   "name it \"hammer\" by a TOML file beside it; of ambient motion leave --kind "
                   "out, or write ambient = true into the campaign");
  }
  if (hammer == nullptr) return "ambient = true\nresponses = " + toml_text(names) + "\n";
  return "force = " + toml_text(hammer->name) + "\nresponses = " + toml_text(names) + "\n";
}

/// The keys of the test and, of an axial test, `length` in those of its recordings.
GuessedTest test_of(const signal::Recording& recording, const NewCommand& command,
                    std::string& of_recording) {
  const auto* const hammer = hammer_of(recording);
  const auto bent = load_deflection(recording);
  GuessedTest test;
  std::tie(test.kind, test.why) = kind_of(recording, command, hammer, bent);
  for (const auto& [key, kinds, unit] : kNeeded) {
    if (std::string_view(kinds).find(test.kind) == std::string_view::npos) continue;
    const double value = command.numbers.at(key);
    if (value == 0) {
      throw UsageError(fmt::format("{}: a test of kind {}: give the {}, {}",
                                   recording.path.string(), test.kind, key,
                                   describe::on_command_line(key)));
    }
    auto& keys = test.kind == "axial" && key == std::string("length") ? of_recording : test.keys;
    keys += fmt::format("{} = {}  # {}\n", key, value, unit);
  }
  test.keys += channel_keys(test.kind, !command.kind.empty(), recording, hammer, bent);
  return test;
}

/// What is said of this recording's channels, as keys of a `channel` table.
std::string channels_text(const signal::Recording& recording, const NewCommand& command) {
  std::string text;
  for (const auto& channel : recording.channels) {
    std::string keys = "{ source = " + toml_text(channel.name);
    const auto given = command.sensitivities.find(channel.name);
    if (given != command.sensitivities.end()) {
      keys += fmt::format(", sensitivity = {}, sensitivity_unit = {}", given->second.first,
                          toml_text(given->second.second));
    } else if (channel.unit.empty()) {
      keys = fmt::format("# the file gives no unit: {}, unit = \"m/s^2\"", keys);
    } else {
      continue;
    }
    text += fmt::format("  {} }},\n", keys);
  }
  return text.empty() ? text : "channel = [\n" + text + "]\n";
}

/// Files, and those in folders, which describe nothing.
std::vector<std::string> files_in(const std::vector<std::string>& given) {
  std::vector<std::string> files;
  for (const auto& one : given) {
    std::error_code none;
    std::vector<std::string> inside;
    for (const auto& entry : fs::recursive_directory_iterator(one, none)) {
      const bool hidden = entry.path().filename().string().starts_with(".");
      if (entry.is_regular_file(none) && !hidden) inside.push_back(entry.path().string());
    }
    if (!fs::is_directory(one, none)) inside.push_back(one);
    std::ranges::sort(inside);
    files.insert(files.end(), inside.begin(), inside.end());
  }
  std::erase_if(files, [](const auto& file) { return fs::path(file).extension() == ".toml"; });
  return files;
}

/// Refuses options that no test of the campaign takes, and channels that no recording has.
void check_options(const std::string& text, const std::vector<std::string>& channels,
                   const NewCommand& command) {
  for (const auto& [key, value] : command.numbers) {
    if (value == 0 || text.find(fmt::format("\n{} = ", key)) != std::string::npos) continue;
    throw UsageError(
        describe::on_command_line(key) +
        " belongs to none of these tests: give the files of such a test alone, with --kind");
  }
  for (const auto& [name, value] : command.sensitivities) {
    if (std::ranges::find(channels, name) != channels.end()) continue;
    throw UsageError("no recording has a channel \"" + name + "\"");
  }
}

/// The campaign of the recordings, which become inputs. A force channel with short pulses makes
/// hits; loads over deflections, with tension or without, a bending test; what is left a free
/// decay, or ambient motion. What cannot be used is warned of ("data_left_out"). Throws UsageError
/// where a test needs a number that is not given or a number is given that no test takes,
/// signal::RecordingError where no file can be read.
std::string guessed_campaign(const NewCommand& command, VerbContext& context) {
  std::vector<GuessedTest> tests;
  std::vector<std::string> channels;
  std::exception_ptr first_error;
  for (const auto& file : files_in(command.from)) {
    try {
      context.input(file);
      signal::Recording recording = load_untold(file, context);
      for (const auto& channel : recording.channels) channels.push_back(channel.name);
      const std::string said = channels_text(recording, command);
      auto table = document::TomlTable::parse(said, file);
      signal::apply_description(signal::read_description(table), recording);
      std::string of_recording;
      GuessedTest test = test_of(recording, command, of_recording);
      if (test.kind == "bending") drop_time_notes(recording);
      tell_notes(recording, context);
      context.out << fmt::format("{}: {} ({})\n", file, test.kind, test.why);
      auto same = std::ranges::find_if(tests, [&](const GuessedTest& other) {
        return other.kind == test.kind && other.keys == test.keys;
      });
      if (same == tests.end()) same = tests.insert(tests.end(), std::move(test));
      const auto path = fs::proximate(fs::absolute(file), fs::absolute(command.folder));
      same->recordings[of_recording + said].push_back(path.string());
    } catch (const std::exception& error) {
      if (exit_code_of(error) != ExitCode::bad_input) throw;
      if (!first_error) first_error = std::current_exception();
      context.warn("data_left_out", std::string("is left out: ") + error.what(), file);
    }
  }
  if (tests.empty() && first_error) std::rethrow_exception(first_error);
  if (tests.empty()) throw UsageError("none of the files is a recording over time or a table");
  std::string text =
      "# A campaign of your own recordings. Run it: rigfit report campaign.toml\n"
      "# Every key: rigfit help campaign. A commented example: rigfit new DIR --example\n\n"
      "title = " +
      toml_text(fs::absolute(command.folder).lexically_normal().filename().string()) + "\n";
  std::map<std::string, int> count;
  for (const auto& test : tests) {
    const int number = ++count[test.kind];
    text += fmt::format("\n[[test]]\nname = \"{0}{1}\"\nkind = \"{0}\"  # {2}\n{3}", test.kind,
                        number == 1 ? "" : fmt::format("-{}", number), test.why, test.keys);
    for (const auto& [keys, taken] : test.recordings) {
      text += "[[test.recording]]\nfiles = " + toml_text(taken) + "\n" + keys;
    }
  }
  check_options(text, channels, command);
  return text;
}

Json run(NewCommand& command, VerbContext& context) {
  std::vector<std::pair<std::string, std::string>> texts;  // name below the folder, content
  if (command.from.empty()) {
    texts = {{"campaign.toml", std::string(assets::new_campaign_toml)},
             {"scenes/cable.toml", std::string(assets::new_cable_toml)},
             {"bending.csv", std::string(assets::new_bending_csv)},
             {"frequencies.csv", std::string(assets::new_frequencies_csv)}};
  } else {
    texts = {{"campaign.toml", guessed_campaign(command, context)}};
  }
  const fs::path root = command.folder;
  for (const auto& [name, content] : texts) {
    std::error_code error;
    if (fs::exists(root / name, error)) {
      throw UsageError((root / name).string() + " exists already; name a folder of its own");
    }
  }
  Json files = Json::array();
  for (const auto& [name, content] : texts) {
    const fs::path path = root / name;
    make_output_folder(path.parent_path());
    write_whole_file(path, content);
    files.push_back(path.string());
    context.out << "wrote " << path.string() << '\n';
  }
  context.out << "next: rigfit report " << (root / "campaign.toml").string() << '\n';
  return Json{{"files", std::move(files)}};
}

describe::Options options_of(NewCommand& c) {
  describe::Options options{
      option("DIR", c.folder, "Folder to make").required(),
      option("--from", c.from, "Recordings, or folders of them, to make a campaign of"),
      option("--example", c.example,
             "The commented example with published values (also without --from)")
          .excludes("--from"),
      option("--kind", c.kind, "What the recordings are [guessed]")
          .one_of(kinds_of_tests())
          .needs("--from"),
      converted(
          "--sensitivity", [&c](const auto& text) { add_sensitivity(text, c); },
          "Of a channel's transducer", describe::Kind::texts)
          .type("\"CHANNEL=2.27 mV/N\"")
          .needs("--from")};
  for (const auto& [key, kinds, unit] : kNeeded) {
    options.push_back(option(describe::on_command_line(key), c.numbers[key],
                             fmt::format("Of tests of kind {}", kinds), unit)
                          .positive()
                          .needs("--from"));
  }
  return options;
}

}  // namespace

Verb new_verb() {
  return verb_of<NewCommand>(
      "new", "Writes a campaign to start from: of one's own recordings, or a commented example",
      "Examples:\n"
      "  rigfit new my-rig --from hits/*.csv --sensitivity \"CH8=2.27 mV/N\"\n"
      "  rigfit new my-rig --example && rigfit report my-rig/campaign.toml",
      run, false, true, []() -> Json {
        return describe::schema_of_keys(
            {{"files", describe::schema_of<std::vector<std::string>>()}});
      });
}

}  // namespace rigfit::apps
