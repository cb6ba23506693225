#include "apps/campaign_file/new/guess_campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <system_error>
#include <utility>

#include "apps/campaign_file/recording_description.h"
#include "signal/impact/pulse_shape.h"
#include "signal/readers/csv/frequency_table.h"
#include "signal/readers/files/foreign_formats.h"
#include "signal/readers/files/mapped_file.h"
#include "signal/readers/read_recording.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

const signal::Channel* channel_like(const signal::Recording& recording,
                                    const std::vector<std::string>& beginnings) {
  for (const auto& beginning : beginnings) {
    for (const auto& channel : recording.channels) {
      if (lower_case(channel.name).starts_with(beginning)) return &channel;
    }
  }
  return nullptr;
}

/// Short pulses over a quiet record: the largest sample stands far above the root mean square.
bool has_pulses(const signal::Channel& channel) {
  double sum = 0, square = 0, largest = 0;
  long count = 0;
  for (const double x : channel.samples) {
    if (!std::isfinite(x)) continue;
    sum += x;
    square += x * x;
    ++count;
  }
  if (count < 64) return false;
  const double mean = sum / static_cast<double>(count);
  const double rms = std::sqrt(std::max(0.0, square / static_cast<double>(count) - mean * mean));
  for (const double x : channel.samples) {
    if (std::isfinite(x)) largest = std::max(largest, std::abs(x - mean));
  }
  // A sine has a crest factor of 1.4, noise of 4 to 5, a decay that fills the record of some 5.
  return rms > 0 && largest > 8 * rms;
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
  std::vector<std::string> responses;  ///< modal, decay, axial
  std::string tension, load, deflection;
  bool without_tension = false;
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

/// One force and one displacement that rise and fall together, a few times at most.
bool is_load_deflection(const signal::Recording& recording) {
  const signal::Channel *load = nullptr, *way = nullptr;
  for (const auto& channel : recording.channels) {
    const bool weights = lower_case(channel.name).starts_with("mass");
    const signal::Channel** slot = weights || channel.quantity == signal::Quantity::force ? &load
                                   : channel.quantity == signal::Quantity::displacement   ? &way
                                                                                          : nullptr;
    if (slot == nullptr) continue;
    if (*slot != nullptr) return false;
    *slot = &channel;
  }
  if (load == nullptr || way == nullptr || !load->samples.allFinite() ||
      !way->samples.allFinite()) {
    return false;
  }
  const Eigen::ArrayXd q = load->samples.array() - load->samples.mean(),
                       d = way->samples.array() - way->samples.mean();
  constexpr int kMostTurns = 20;  // of a bending test; a vibration has more
  int crossings = 0;
  for (Eigen::Index i = 1; i < d.size(); ++i) crossings += (d[i - 1] < 0) != (d[i] < 0) ? 1 : 0;
  return crossings < kMostTurns &&
         std::abs((q * d).sum()) > 0.8 * std::sqrt(q.square().sum() * d.square().sum());
}

Guess guess_of(const signal::Recording& recording, const GuessOptions& options) {
  Guess guess;
  guess.kind = options.kind;
  const auto* const tension = channel_like(recording, {"tension", "preload"});
  const auto* const load = channel_like(recording, {"load", "force", "q"});
  const auto* const deflection = channel_like(recording, {"deflection", "displacement", "lvdt"});
  const auto* const hammer = hammer_of(recording, options);
  if (guess.kind.empty()) {
    if (tension != nullptr && load != nullptr && deflection != nullptr) {
      guess.kind = "bending";
      guess.why = "channels of tension, load and deflection";
    } else if (hammer != nullptr && recording.channels.size() > 1) {
      guess.kind = "modal";
      guess.why = "pulses of a hammer on channel " + hammer->name;
      if (hammer->quantity == signal::Quantity::voltage &&
          !options.sensitivities.contains(hammer->name)) {
        guess.why += fmt::format(", in V: say --sensitivity \"{}=X mV/N\"", hammer->name);
      }
    } else if (hammer == nullptr && tension == nullptr && is_load_deflection(recording)) {
      guess.kind = "bending";
      guess.why = "load over deflection, no tension; how it is held is assumed";
    } else {
      guess.kind = "decay";
      guess.why = "no hammer and no load-deflection pair: taken as free vibration";
    }
  } else {
    guess.why = "as said by --kind";
  }
  if (guess.kind == "bending") {
    guess.without_tension = tension == nullptr && is_load_deflection(recording);
    guess.tension = tension == nullptr ? "" : tension->name;
    guess.load = load == nullptr ? "" : load->name;
    guess.deflection = deflection == nullptr ? "" : deflection->name;
    return guess;
  }
  if (guess.kind == "modal") {
    if (hammer == nullptr) {
      throw UsageError(recording.path.string() +
                       ": which channel is the hammer? say it with --force-channel C");
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

/// The keys of a test; `files` are relative to the campaign.
std::string test_text(const std::string& name, const Guess& guess, const GuessOptions& options,
                      const std::vector<std::string>& files) {
  std::string text =
      fmt::format("\n[[test]]\nname = \"{}\"\nkind = \"{}\"  # {}\n", name, guess.kind, guess.why);
  if (guess.kind == "bending") {
    if (!(options.span_m > 0)) {
      throw UsageError(files.front() +
                       " is a bending test: give its span between the clamps, --span M");
    }
    text +=
        fmt::format("span = {}  # m, {}\n", options.span_m,
                    guess.without_tension ? "between clamps or supports; cantilever: to the load"
                                          : "clamp to clamp");
    if (guess.without_tension) {
      text +=
          "tension = 0\nends = \"clamped\"  # or \"pinned\" (on two supports), "
          "\"cantilever\"\n"
          "# rectangle = [0.02, 0.003]  # m, width and height: gives the modulus\n";
    }
    if (!guess.tension.empty() && !guess.load.empty() && !guess.deflection.empty()) {
      text += fmt::format("channels = {{ tension = {}, load = {}, deflection = {} }}\n",
                          quoted(guess.tension), quoted(guess.load), quoted(guess.deflection));
    }
  } else if (guess.kind == "axial") {
    if (!(options.mass_kg > 0) || !(options.length_m > 0)) {
      throw UsageError(files.front() + " is an axial test: give --mass KG and --length M");
    }
    text += fmt::format("mass = {}  # kg, adapter included\n", options.mass_kg);
    if (!guess.responses.empty()) text += "channel = " + quoted(guess.responses.front()) + "\n";
  } else if (guess.kind == "modal") {
    text += "force = " + quoted(guess.force) + "\nresponses = " + list_of(guess.responses) + "\n";
  } else {
    text += "channels = " + list_of(guess.responses) + "\n";
  }
  text += "[[test.recording]]\nfiles = " + list_of(files) + "\n";
  if (guess.kind == "axial") text += fmt::format("length = {}  # m of cable\n", options.length_m);
  return text;
}

/// The channels of a folder's recordings, each once, with what a person said of them.
std::string channels_text(const std::vector<const signal::Recording*>& recordings,
                          const GuessOptions& options) {
  std::string text =
      "# Channels of the recordings in this folder (rigfit help sidecar: every key).\n";
  std::vector<std::string> done;
  for (const auto* recording : recordings) {
    for (const auto& channel : recording->channels) {
      if (std::find(done.begin(), done.end(), channel.name) != done.end()) continue;
      done.push_back(channel.name);
      text += "\n[[channel]]\nsource = " + quoted(channel.name) + "\n";
      if (const auto given = options.sensitivities.find(channel.name);
          given != options.sensitivities.end()) {
        const std::size_t blank = given->second.find(' ');
        const std::string number = given->second.substr(0, blank);
        if (blank == std::string::npos || number.empty() ||
            number.find_first_not_of("+-.0123456789eE") != std::string::npos) {
          throw UsageError("--sensitivity " + channel.name + "=" + given->second +
                           ": write it with its unit, such as \"" + channel.name + "=2.27 mV/N\"");
        }
        text += "sensitivity = " + number +
                "\nsensitivity_unit = " + quoted(given->second.substr(blank + 1)) + "\n";
      } else if (const auto unit = options.units.find(channel.name); unit != options.units.end()) {
        if (!signal::parse_unit(unit->second)) {
          throw UsageError("--unit " + channel.name + "=" + unit->second + ": no unit we know");
        }
        text += "unit = " + quoted(unit->second) + "\n";
      } else if (channel.unit.empty()) {
        text +=
            "# unit = \"m/s^2\"  # the file gives none; or: sensitivity = 10.0, sensitivity_unit "
            "= \"mV/g\"\n";
      } else {
        text += "# in " + channel.unit + " by the file\n";
      }
    }
  }
  return text;
}

/// Functions over frequency, which no campaign takes.
bool over_frequency(const std::string& file, VerbContext& context) {
  const signal::MappedFile mapped(file);
  return context.reading.format.empty() && !signal::foreign_format(mapped.bytes()) &&
         signal::format_of(mapped.bytes()) == signal::RecordingFormat::csv &&
         signal::read_frequency_table(mapped.bytes(), file, context.reading).has_value();
}

}  // namespace

GuessedCampaign guess_campaign(const fs::path& folder, const std::vector<std::string>& files,
                               const GuessOptions& options, VerbContext& context) {
  GuessedCampaign result;
  struct Test {
    Guess guess;
    std::vector<std::string> files;
  };
  std::vector<Test> tests;
  std::vector<std::pair<fs::path, signal::Recording>> read;
  for (const auto& file : files) {
    if (fs::path(file).extension() == ".toml") continue;
    context.input(file);
    if (over_frequency(file, context)) {
      result.remarks.push_back(file +
                               ": over frequency, left out; look at it by rigfit inspect or "
                               "rigfit modal");
      continue;
    }
    signal::Recording recording = load_recording(file, context);
    const Guess guess = guess_of(recording, options);
    if (recording.sample_rate_hz == 0 && guess.kind != "bending") {
      throw UsageError(file + " gives no sample rate: write sample_rate_hz = ... into a " +
                       fs::path(file).replace_extension(".toml").filename().string() +
                       " beside it");
    }
    result.remarks.push_back(fmt::format("{}: {} ({})", file, guess.kind, guess.why));
    std::error_code error;
    const fs::path relative = fs::proximate(fs::absolute(file), fs::absolute(folder), error);
    const std::string name = error ? fs::absolute(file).string() : relative.string();
    const auto same = std::find_if(tests.begin(), tests.end(), [&](const Test& test) {
      return test.guess.kind == guess.kind && test.guess.force == guess.force &&
             test.guess.without_tension == guess.without_tension &&
             test.guess.responses == guess.responses;
    });
    if (same != tests.end()) {
      same->files.push_back(name);
    } else {
      tests.push_back({guess, {name}});
    }
    read.emplace_back(fs::path(file).parent_path(), std::move(recording));
  }
  if (tests.empty()) throw UsageError("none of the files is a recording over time");
  for (const auto* map : {&options.units, &options.sensitivities}) {
    for (const auto& entry : *map) {
      const std::string& name = entry.first;
      const bool known = std::any_of(read.begin(), read.end(), [&](const auto& one) {
        return std::any_of(one.second.channels.begin(), one.second.channels.end(),
                           [&](const auto& channel) { return channel.name == name; });
      });
      if (!known) throw UsageError("no recording has a channel \"" + name + "\"");
    }
  }
  std::string text =
      "# A campaign of your own recordings. Run it: rigfit report campaign.toml --out report\n"
      "# Every key: rigfit help campaign. A commented example: rigfit new DIR --example\n\n"
      "title = " +
      quoted(fs::absolute(folder).lexically_normal().filename().string()) + "\n";
  std::map<std::string, int> count;
  for (const auto& test : tests) {
    const int number = ++count[test.guess.kind];
    text += test_text(number == 1 ? test.guess.kind : fmt::format("{}-{}", test.guess.kind, number),
                      test.guess, options, test.files);
  }
  result.files.push_back({folder / "campaign.toml", std::move(text)});
  std::map<fs::path, std::vector<const signal::Recording*>> folders;
  for (const auto& [place, recording] : read) folders[place].push_back(&recording);
  for (const auto& [place, recordings] : folders) {
    result.files.push_back({place / "channels.toml", channels_text(recordings, options)});
  }
  return result;
}

}  // namespace rigfit::apps
