#include "signal/recording/recording_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "signal/recording/recording_error.h"
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

void take_times(const TimeAxis& axis, const ReadTimes& times, Recording& recording) {
  const auto note = [&](const char* code, std::string message, std::string where = "") {
    recording.notes.push_back({code, std::move(message), std::move(where)});
  };
  const auto line = [&](Eigen::Index sample) {
    return times.first_line == 0 ? fmt::format("near sample {}", sample + 1)
                                 : fmt::format("near line {}", times.first_line + sample);
  };
  recording.sample_rate_hz = axis.rate_hz;
  recording.start_time_s = std::isfinite(axis.start_s) ? axis.start_s : 0;
  recording.time_jitter_s = axis.jitter_s;
  const bool is_known = axis.rate_hz > 0, is_uneven = is_known && !axis.uniform;
  if (axis.backward > 0 || axis.repeated > 0) {
    note("time_axis",
         fmt::format("times go back {} times and repeat {} times", axis.backward, axis.repeated),
         line(axis.first_fault));
  }
  if (axis.gaps > 0) {
    note("time_axis",
         fmt::format("{} gaps in the times, the longest {:.9g} s", axis.gaps, axis.longest_gap_s),
         line(axis.longest_gap_at));
  }
  if (axis.missing > 0) note("time_missing", fmt::format("{} times are missing", axis.missing));
  if (is_uneven) {
    note("time_axis",
         fmt::format("sampling is not uniform (rms departure {:.9g} s)", axis.jitter_s));
  } else if (is_known && times.printed_resolution_s * axis.rate_hz > 1) {
    note("read_as", fmt::format("times are rounded to {:.9g} s, coarser than the sampling step; "
                                "the rate is that of the whole record",
                                times.printed_resolution_s));
  }
  if (is_known && !axis.agrees_with_stated) {
    note("rates_disagree",
         fmt::format("the times give {:.9g} Hz, {}: the times are taken", axis.rate_hz,
                     times.stated),
         times.stated_where);
  }
  if (is_uneven && axis.missing > 0) {
    Eigen::Index at = 0;
    while (std::isfinite(times.time_s[at])) ++at;
    const bool by_line = times.first_line > 0;
    throw RecordingError({recording.path.string(), by_line ? times.first_line + at : 0, 0,
                          times.name, by_line ? "" : fmt::format("sample {}", at + 1)},
                         "the time is missing and sampling is not uniform",
                         "fix the times, or delete that column and give the sample rate");
  }
  if (is_uneven) recording.time_s = times.time_s;
  if (!is_known && times.time_s.size() > 1) {
    note("time_axis", "Give the sample rate: the times do not rise", times.name);
  }
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
