#include "signal/recording/recording_time.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "signal/recording/units.h"

namespace rigfit::signal {

void take_stated_rate(double rate_hz, Recording& recording) {
  if (!(rate_hz > 0)) return;
  const double of_file = recording.sample_rate_hz;
  if (of_file > 0 && std::abs(of_file / rate_hz - 1) > 1e-4) {
    recording.notes.push_back(
        {"read_as",
         fmt::format("the file gives {:.9g} Hz; {:.9g} Hz is taken as asked", of_file, rate_hz),
         ""});
    recording.time_s.resize(0);
  }
  recording.sample_rate_hz = rate_hz;
  recording.sample_rate_relative_std = 0;
}

void take_unit(const std::string& text, Channel& channel, std::vector<Note>& notes) {
  channel.source_unit = text;
  if (const auto unit = parse_unit(text)) {
    channel.unit = unit->si;
    channel.si_per_source = unit->factor;
    channel.si_offset = unit->offset;
    if (unit->quantity != Quantity::unknown) channel.quantity = unit->quantity;
  } else if (!text.empty()) {
    notes.push_back({"unknown_unit",
                     "unit \"" + text + "\" is not known: the numbers are kept as they are",
                     channel.name});
  }
}

void take_samples(Eigen::VectorXd numbers, Channel& channel) {
  channel.samples = std::move(numbers);
  channel.missing_samples = 0;
  const double factor = channel.si_per_source, offset = channel.si_offset;
  for (double& x : channel.samples) {
    x = x * factor + offset;
    if (std::isfinite(x)) continue;
    x = std::numeric_limits<double>::quiet_NaN();
    ++channel.missing_samples;
  }
}

std::string unused_name(const std::string& name, std::set<std::string>& used) {
  std::string own = name;
  for (int k = 2; !used.insert(own).second; ++k) own = name + "_" + std::to_string(k);
  return own;
}

Note not_uniform_note(const TimeAxis& axis) {
  return {"time_axis",
          fmt::format("sampling is not uniform: times go back {} times, repeat {} times, {} gaps",
                      axis.backward, axis.repeated, axis.gaps),
          ""};
}

void note_unitless(Recording& recording) {
  std::erase_if(recording.notes, [](const Note& note) { return note.code == "no_unit"; });
  std::vector<std::string> names;
  for (const auto& channel : recording.channels) {
    if (channel.source_unit.empty() && channel.unit.empty()) names.push_back(channel.name);
  }
  if (names.empty()) return;
  recording.notes.push_back(
      {"no_unit", "no unit in the file: the numbers are kept as they are", listed(names)});
}

void shorten(std::vector<Note>& notes) {
  std::map<std::string, std::size_t> count;
  for (const auto& note : notes) ++count[note.code];
  std::map<std::string, std::size_t> seen;
  std::erase_if(notes, [&](Note& note) {
    const std::size_t place = ++seen[note.code], all = count[note.code];
    if (place == kMostListed && all > kMostListed) {
      note.message += " (and " + std::to_string(all - kMostListed) + " more of this kind)";
    }
    return place > kMostListed;
  });
}

}  // namespace rigfit::signal
