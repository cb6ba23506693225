// What readers do alike: sampling, units, names, notes.
#pragma once

#include <fmt/format.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "signal/recording/recording.h"
#include "signal/recording/time_axis.h"

namespace rigfit::signal {

/// Adds a note whose message is made of its values.
template <typename... Values>
void add_note(std::vector<Note>& notes, std::string code, std::string where,
              fmt::format_string<Values...> message, Values&&... values) {
  notes.push_back(
      {std::move(code), fmt::format(message, std::forward<Values>(values)...), std::move(where)});
}

/// Takes the sample rate that somebody states, as exact, in place of what the file gives; 0: none
/// is stated. Notes "read_as" where the file's differs by more than 1e-4, relative: then
/// its times no longer hold either and go. Notes "no_sample_rate" where there is none.
void take_stated_rate(double rate_hz, Recording& recording);

/// The unit of a channel as its file writes it: SI symbol, factor, offset and quantity. One that is
/// not known is noted ("unknown_unit"), unless it is empty.
void take_unit(const std::string& text, Channel& channel, std::vector<Note>& notes);

/// Numbers of a file as samples in SI; what is no number is missing.
void take_samples(Eigen::VectorXd numbers, Channel& channel);

/// `name`, or with "_2", "_3" ... behind it where it is used already.
[[nodiscard]] std::string unused_name(const std::string& name, std::set<std::string>& used);

/// "no_unit", in one note, for the channels for which neither file nor description gives one.
void note_unitless(Recording& recording);

/// Leaves the first 20 notes of each code and says in the last of them how many there were.
void shorten(std::vector<Note>& notes);

/// A file's column of times.
struct ReadTimes {
  Eigen::VectorXd time_s;
  double printed_resolution_s = 0;  ///< one unit of the last printed digit; 0: full precision
  std::string stated;               ///< "the header says 100 Hz", for people
  std::string stated_where;         ///< such as "line 3"
  std::string name;                 ///< as the column has it
  long first_line = 0;              ///< line of the first time; 0: none
};

/// Takes rate, start and jitter of the recording from its times, which are kept where sampling is
/// not uniform, and notes what is wrong with them. Throws RecordingError when sampling is not
/// uniform and times are missing.
void take_times(const TimeAxis& axis, const ReadTimes& times, Recording& recording);

}  // namespace rigfit::signal
