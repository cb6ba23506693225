#include "signal/recording/recording_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "signal/numerics/numbers.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::signal {

void take_stated_rate(double rate_hz, Recording& recording) {
  const double of_file = std::isfinite(recording.sample_rate_hz) ? recording.sample_rate_hz : 0;
  recording.sample_rate_hz = rate_hz > 0 ? rate_hz : of_file;
  if (!(recording.sample_rate_hz > 0)) {
    add_note(recording.notes, "no_sample_rate", "",
             "neither times nor a sample rate in the file: give it (--sample-rate, or "
             "sample_rate_hz in the TOML file beside the recording)");
  }
  if (!(rate_hz > 0)) return;
  recording.sample_rate_relative_std = 0;
  if (of_file > 0 && std::abs(of_file / rate_hz - 1) > 1e-4) {
    add_note(recording.notes, "read_as", "",
             "the file gives {:.9g} Hz; {:.9g} Hz is taken as asked", of_file, rate_hz);
    recording.time_s.resize(0);
  }
}

void take_unit(const std::string& text, Channel& channel, std::vector<Note>& notes) {
  channel.source_unit = text;
  if (const auto unit = parse_unit(text)) {
    channel.unit = unit->si;
    channel.si_per_source = unit->factor;
    channel.si_offset = unit->offset;
    if (unit->quantity != Quantity::unknown) channel.quantity = unit->quantity;
  } else if (!text.empty()) {
    add_note(notes, "unknown_unit", channel.name,
             "unit \"{}\" is not known: the numbers are kept as they are", text);
  }
}

void take_samples(Eigen::VectorXd numbers, Channel& channel) {
  channel.samples = std::move(numbers);
  channel.samples.array() = channel.samples.array() * channel.si_per_source + channel.si_offset;
  for (double& x : channel.samples) x = std::isfinite(x) ? x : kNaN;
  channel.missing_samples = channel.samples.array().isNaN().count();
}

std::string unused_name(const std::string& name, std::set<std::string>& used) {
  std::string own = name;
  for (int k = 2; !used.insert(own).second; ++k) own = name + "_" + std::to_string(k);
  return own;
}

void take_times(const TimeAxis& axis, const ReadTimes& times, Recording& recording) {
  auto& notes = recording.notes;
  const auto line = [&](Eigen::Index sample) {
    return times.first_line == 0 ? fmt::format("near sample {}", sample + 1)
                                 : fmt::format("near line {}", times.first_line + sample);
  };
  recording.sample_rate_hz = axis.rate_hz;
  recording.start_time_s = std::isfinite(axis.start_s) ? axis.start_s : 0;
  recording.time_jitter_s = axis.jitter_s;
  const bool is_known = axis.rate_hz > 0, is_uneven = is_known && !axis.uniform;
  if (axis.backward > 0 || axis.repeated > 0) {
    add_note(notes, "time_axis", line(axis.first_fault),
             "times go back {} times and repeat {} times", axis.backward, axis.repeated);
  }
  if (axis.gaps > 0) {
    add_note(notes, "time_axis", line(axis.longest_gap_at),
             "{} gaps in the times, the longest {:.9g} s", axis.gaps, axis.longest_gap_s);
  }
  if (axis.missing > 0) add_note(notes, "time_missing", "", "{} times are missing", axis.missing);
  if (is_uneven) {
    add_note(notes, "time_axis", "", "sampling is not uniform (rms departure {:.9g} s)",
             axis.jitter_s);
  } else if (is_known && times.printed_resolution_s * axis.rate_hz > 1) {
    add_note(notes, "read_as", "",
             "times are rounded to {:.9g} s, coarser than the sampling step; "
             "the rate is that of the whole record",
             times.printed_resolution_s);
  }
  if (is_known && !axis.agrees_with_stated) {
    add_note(notes, "rates_disagree", times.stated_where,
             "the times give {:.9g} Hz, {}: the times are taken", axis.rate_hz, times.stated);
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
    add_note(notes, "time_axis", times.name, "Give the sample rate: the times do not rise");
  }
}

void note_unitless(Recording& recording) {
  std::vector<std::string> names;
  for (const auto& channel : recording.channels) {
    if (channel.source_unit.empty() && channel.unit.empty()) names.push_back(channel.name);
  }
  const auto known = std::ranges::find(recording.notes, "no_unit", &Note::code);
  if (known != recording.notes.end()) {
    known->where = listed(names);
    if (names.empty()) recording.notes.erase(known);
  } else if (!names.empty()) {
    add_note(recording.notes, "no_unit", listed(names),
             "no unit in the file: the numbers are kept as they are");
  }
}

void shorten(std::vector<Note>& notes) {
  std::map<std::string, std::size_t> count, seen;
  for (const auto& note : notes) ++count[note.code];
  std::erase_if(notes, [&](Note& note) {
    const std::size_t place = ++seen[note.code], all = count[note.code];
    if (place == kMostListed && all > kMostListed) {
      note.message += " (and " + std::to_string(all - kMostListed) + " more of this kind)";
    }
    return place > kMostListed;
  });
}

}  // namespace rigfit::signal
