#include "signal/readers/recording_description.h"

#include "document/toml_table.h"
#include "signal/recording/recording_time.h"

namespace rigfit::signal {
namespace fs = std::filesystem;
namespace {

ChannelDescription read_channel(document::TomlTable& table) {
  ChannelDescription channel;
  channel.source = table.string("source");
  channel.name = table.string_or("name", "");
  channel.unit = table.string_or("unit", "");
  channel.scale =
      table.optional_number("scale", document::Bound::any, "unit per number in the file");
  channel.offset = table.number_or("offset", document::Bound::any, "unit", 0);
  channel.sensitivity =
      table.optional_number("sensitivity", document::Bound::any, "sensitivity_unit");
  channel.sensitivity_unit = table.string_or("sensitivity_unit", "");
  channel.range = table.number_or("range", document::Bound::not_negative, "unit", 0);
  const auto refuse_if = [&](bool wrong, const char* key, const std::string& problem,
                             const char* remedy) {
    if (wrong) throw table.error(key, problem, remedy);
  };
  if (table.has("direction")) {
    const auto d = table.numbers("direction", 3, 3, document::Bound::any, "1");
    const double length = std::hypot(d[0], d[1], d[2]);
    refuse_if(!(length > 0), "direction", "is zero", "give the direction of positive values");
    channel.direction = {d[0] / length, d[1] / length, d[2] / length};
  }
  const auto quotient = parse_quotient(channel.sensitivity_unit);
  const auto unit = parse_unit(channel.unit);
  const bool scaled = channel.sensitivity.has_value();
  refuse_if(channel.scale == 0.0, "scale", "is zero", "give unit per number in the file");
  refuse_if(channel.sensitivity == 0.0, "sensitivity", "is zero",
            "give the transducer's, such as 2.27 mV/N");
  refuse_if(scaled && channel.scale, "scale", "stands beside a sensitivity", "give one of the two");
  refuse_if(scaled != !channel.sensitivity_unit.empty() || (scaled && !quotient),
            "sensitivity_unit", "is not a quotient of two units",
            "write the sensitivity with its unit, such as 2.27 and \"mV/N\"");
  if (channel.unit.empty()) return channel;
  refuse_if(!unit, "unit", "\"" + channel.unit + "\" is no unit we know",
            "write it like \"N\", \"m/s^2\", \"g\", \"mm\"");
  refuse_if(scaled && unit->si != quotient->over.si, "unit",
            "does not fit a sensitivity in " + channel.sensitivity_unit,
            "beside a sensitivity it is the unit of the file's numbers, such as \"V\"");
  return channel;
}

RecordingError refused(const Recording& recording, const std::string& channel, std::string problem,
                       std::string remedy, const std::string& value = "") {
  return {{recording.path.string(), 0, 0, channel, value}, std::move(problem), std::move(remedy)};
}

void apply_channel(const ChannelDescription& given, const Recording& recording, Channel& channel) {
  // Back to the file's numbers: x = a * file + b is replaced as a whole.
  double a = channel.si_per_source, b = channel.si_offset;
  if (given.sensitivity) {
    const UnitQuotient by = *parse_quotient(given.sensitivity_unit);
    const auto file_unit = parse_unit(given.unit.empty() ? channel.source_unit : given.unit);
    const auto refuse = [&](std::string problem, std::string remedy) {
      throw refused(recording, channel.name, std::move(problem), std::move(remedy),
                    channel.source_unit);
    };
    if (!file_unit) {
      refuse(
          "the file gives no unit for it",
          fmt::format("say in which unit its numbers are, as unit = \"{}\", beside sensitivity = "
                      "... {}: V for mV makes a factor of a thousand",
                      by.over_text, given.sensitivity_unit));
    }
    if (file_unit->si != by.over.si) {
      refuse("the file's unit does not fit a sensitivity in " + given.sensitivity_unit,
             "give the sensitivity in that unit per unit of what is measured");
    }
    a = file_unit->factor / (*given.sensitivity * by.over.factor) * by.under.factor;
    b = 0;
    channel.unit = by.under.si;
    channel.quantity = by.under.quantity;
  } else if (!given.unit.empty() || given.scale || given.offset != 0) {
    const auto unit = parse_unit(given.unit.empty() ? channel.source_unit : given.unit);
    const double factor = unit ? unit->factor : 1;
    a = given.scale.value_or(1) * factor;
    b = given.offset * factor + (unit ? unit->offset : 0);
    channel.unit = unit ? unit->si : "";
    channel.quantity = unit ? unit->quantity : Quantity::unknown;
  }
  if (a != channel.si_per_source || b != channel.si_offset) {
    const double ratio = a / channel.si_per_source;
    channel.samples = ((channel.samples.array() - channel.si_offset) * ratio + b).matrix();
    channel.nominal_range *= std::abs(ratio);
    channel.si_per_source = a;
    channel.si_offset = b;
  }
  if (given.range > 0) {
    const auto unit = given.sensitivity ? std::nullopt : parse_unit(given.unit);
    channel.nominal_range = given.range * (unit ? unit->factor : 1);
  }
  if (given.direction) channel.direction = *given.direction;
  if (!given.name.empty()) channel.name = given.name;
}

/// Notes values that hardly any laboratory measures: most often a sensitivity or unit off by a
/// thousand. Zeros and channels without a number are not judged.
void judge_values(const Channel& channel, std::vector<Note>& notes) {
  const auto unit = parse_unit(channel.source_unit);
  const bool by_voltage = unit && unit->quantity == Quantity::voltage;
  struct Limits {
    Quantity quantity;
    double least, most;  // bounds of the largest magnitude
  };
  // A tenth of a millionth of g is below every sensor's noise, 10000 g is a shock, beyond what
  // vibration is measured with. Hammers and dynamic load cells end before 100 kN.
  const Limits all[] = {{Quantity::acceleration, 1e-6, 1e5},
                        {Quantity::force, by_voltage ? 1e-3 : 0, by_voltage ? 1e5 : 1e8},
                        {Quantity::displacement, 0, 1000},
                        {Quantity::velocity, 0, 1e4}};
  const auto* const limits = std::ranges::find(all, channel.quantity, &Limits::quantity);
  if (limits == std::end(all)) return;
  const auto x = channel.samples.array();
  const double largest = x.isNaN().select(0, x).abs().maxCoeff();
  if (!(largest > 0) || (largest >= limits->least && largest <= limits->most)) return;
  add_note(notes, "unit_suspected", channel.name,
           "Check unit, sensitivity and scale (unit in the file: \"{}\"): it reaches {:.3g} {}{}, "
           "{} than such a channel measures; V for mV makes a factor of a thousand",
           channel.source_unit, largest, channel.unit,
           channel.unit == "m/s^2" ? fmt::format(" ({:.2g} g)", largest / 9.80665) : "",
           largest > limits->most ? "more" : "less");
}

/// Notes channels that the folder's channels.toml describes and this recording lacks: the other
/// recordings may have them, unless it describes none of this one's, or the name is misspelt.
void note_absent(const std::vector<std::string>& absent, const std::vector<std::string>& left,
                 bool none_described, Recording& recording) {
  std::vector<std::string> names;
  for (const auto& name : absent) {
    const auto nearest = document::nearest_word(name, left);
    if (nearest) names.push_back(name + "\" (did you mean \"" + *nearest);
    if (!nearest && none_described) names.push_back(name);
  }
  if (names.empty()) return;
  add_note(recording.notes, "described_channel_absent", "",
           "channels.toml of the folder describes {}, which this recording does not have",
           listed(names));
}

}  // namespace

RecordingDescription read_description(document::TomlTable& table) {
  RecordingDescription description;
  ReadOptions& reading = description.reading;
  reading.sample_rate_hz =
      table.optional_number("sample_rate_hz", document::Bound::positive, "Hz").value_or(0);
  if (table.has("time_unit")) {
    const std::string text = table.string("time_unit");
    const auto unit = parse_unit(text);
    if (!unit || unit->quantity != Quantity::time) {
      throw table.error("time_unit", "\"" + text + "\" is no unit of time",
                        "write \"s\", \"ms\", \"us\" or \"min\"");
    }
    reading.time_unit_s = unit->factor;
  }
  reading.decimal = sign_named(table.choice_or("decimal", {".", ",", "point", "comma"}, ""));
  reading.separator = sign_named(table.choice_or(
      "separator", {"comma", "semicolon", "tab", "blank", "space", ",", ";", "\t", "\\t", " "},
      ""));
  reading.format = table.choice_or("format", format_names(), "");
  if (table.has("variables")) reading.variables = table.strings("variables");
  for (auto& entry : table.tables_or_empty("channel")) {
    description.channels.push_back(read_channel(entry));
    entry.finish();
  }
  return description;
}

char sign_named(const std::string& text) {
  if (text.size() == 1 && std::string(",;.\t ").find(text[0]) != std::string::npos) return text[0];
  static const std::map<std::string, char> kNames = {
      {"comma", ','}, {"semicolon", ';'}, {"tab", '\t'}, {"\\t", '\t'},
      {"blank", ' '}, {"space", ' '},     {"point", '.'}};
  const auto found = kNames.find(text);
  return found == kNames.end() ? char{0} : found->second;
}

ReadOptions merged(ReadOptions first, const ReadOptions& second) {
  const ReadOptions none;
  const auto merge = [&](auto member) {
    if (first.*member == none.*member) first.*member = second.*member;
  };
  merge(&ReadOptions::sample_rate_hz);
  merge(&ReadOptions::time_unit_s);
  merge(&ReadOptions::decimal);
  merge(&ReadOptions::separator);
  merge(&ReadOptions::format);
  merge(&ReadOptions::variables);
  return first;
}

void apply_description(const RecordingDescription& description, Recording& recording) {
  std::vector<std::string> absent, left;  // described and not there; there and not described
  if (description.of_folder) {
    for (const auto& channel : recording.channels) left.push_back(channel.name);
  }
  // All by the names in the file, before any is renamed.
  std::map<Index, const ChannelDescription*> described;
  for (const auto& channel : description.channels) {
    Index at = 0;
    try {
      at = recording.channel_index(channel.source);
    } catch (const RecordingError&) {
      if (!description.of_folder) throw;
      absent.push_back(channel.source);
      continue;
    }
    std::erase(left, recording.channels[static_cast<std::size_t>(at)].name);
    if (!described.emplace(at, &channel).second) {
      throw refused(recording, channel.source, "is described twice", "keep one of the two");
    }
  }
  for (const auto& [at, given] : described) {
    apply_channel(*given, recording, recording.channels[static_cast<std::size_t>(at)]);
  }
  std::set<std::string> names;
  for (const auto& channel : recording.channels) {
    if (!names.insert(channel.name).second) {
      throw refused(recording, channel.name, "is the name of two channels",
                    "give each a name of its own, in the description");
    }
  }
  std::erase_if(recording.notes, [](const Note& note) { return note.code == "unit_suspected"; });
  for (const auto& channel : recording.channels) judge_values(channel, recording.notes);
  note_absent(absent, left, absent.size() == description.channels.size(), recording);
  note_unitless(recording);  // what is described has its unit from the description
}

std::vector<fs::path> descriptions_of(const fs::path& recording) {
  fs::path own = recording;
  own.replace_extension(".toml");
  std::vector<fs::path> files{recording.parent_path() / "channels.toml", own};
  std::erase_if(files, [&](const fs::path& file) {
    std::error_code ignored;
    return file == recording || !fs::is_regular_file(file, ignored);
  });
  return files;
}

RecordingDescription read_description(const fs::path& file) {
  auto table = document::TomlTable::read_file(file);
  RecordingDescription description = read_description(table);
  table.finish();
  description.of_folder = file.filename() == "channels.toml";
  return description;
}

}  // namespace rigfit::signal
