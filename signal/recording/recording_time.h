// What readers do alike: times and rates, units, names.
#pragma once

#include <set>

#include "signal/recording/add_note.h"

namespace rigfit::signal {

/// Takes the sample rate that somebody states, as exact, in place of what the file gives; 0: none
/// is stated. Uneven times go. Notes "read_as" where there are any, or where the file's rate
/// differs by more than 1e-4, relative. Notes "no_sample_rate" where there is none.
void take_stated_rate(double rate_hz, Recording& recording);

/// The unit of a channel as its file writes it: SI symbol, factor, offset and quantity. One that is
/// not known is noted ("unknown_unit"), unless it is empty.
void take_unit(const std::string& text, Channel& channel, std::vector<Note>& notes);

/// Numbers of a file as samples in SI; what is no number is missing.
void take_samples(VectorXd numbers, Channel& channel);

/// `name`, or with "_2", "_3" ... behind it where it is used already.
[[nodiscard]] std::string unused_name(const std::string& name, std::set<std::string>& used);

/// "no_unit", in one note, for the channels for which neither file nor description gives one.
void note_unitless(Recording& recording);

/// Leaves the first 20 notes of each code and says in the last of them how many there were.
void shorten(std::vector<Note>& notes);

struct TimeAxis {
  double rate_hz = 0;            ///< 0: not to be had (fewer than two times, or they do not rise)
  double rate_relative_std = 0;  ///< rounding of the printed times; 0: an exact or a usual rate
  double start_s = 0;
  double jitter_s = 0;  ///< rms departure from uniform sampling
  bool uniform = false;
  double printed_resolution_s = 0;  ///< one unit of the last printed digit; 0: full precision
  bool agrees_with_stated = true;   ///< true also when nothing is stated
  long missing = 0;                 ///< NaN among the times
  long repeated = 0;                ///< steps of zero that printing does not explain
  long backward = 0;
  long gaps = 0;           ///< steps over 1.5 of the usual one
  Index first_fault = -1;  /// sample after the first repeated, backward or long step
  Index longest_gap_at = -1;
  double longest_gap_s = 0;
};

/// The sample rate that a column of times shows, and how far the column departs from it.
///
/// t_k = start + k / rate: of printed times the middle of the steps whose line leaves all times
/// within one digit, with half of their range over sqrt(3) as std; of others least squares.
/// Departures that printing explains (half of the last digit) and those below a hundredth of a step
/// leave the sampling uniform; a row that is lost or doubled where one digit is about a step counts
/// as a gap or as repeated all the same. `stated_rate_hz`: by a header; taken when the times agree
/// with it; 0: none. A step that is a whole number of printed digits throughout is exact; so is a
/// rate far rounder than chance explains, where the times leave 3e-4 at most.
[[nodiscard]] TimeAxis time_axis(const Ref<const VectorXd>& time_s, double printed_resolution_s = 0,
                                 double stated_rate_hz = 0);

/// A rate from a step printed with few digits.
struct RateOfStep {
  double rate_hz = 0;
  double relative_std = 0;  ///< rounding, uniform; 0: the step is a rate's own decimal fraction
};

/// `half_digit`: half a unit of the step's last printed digit. A step that is the exact decimal of
/// one over a round rate (0.001) gives that rate. Else the one rate that prints as this step and is
/// a power of two or has two digits is taken, if there is exactly one; else the whole number of
/// hertz that does, where the digits tell these apart; else one over the step.
[[nodiscard]] RateOfStep rate_of_step(double step_s, double half_digit);

/// The roundest rate within `tolerance` (relative) of `rate_hz`: 65535.95 -> 65536 at 1e-5.
[[nodiscard]] double round_rate(double rate_hz, double tolerance);

/// Takes rate, start and jitter of the recording from a file's column of times, which are kept
/// where sampling is not uniform, and notes what is wrong with them. `name`: as the column has it;
/// `first_line`: line of the first time, 0: none. Throws RecordingError when sampling is not
/// uniform and times are missing.
void take_times(const TimeAxis& axis, const VectorXd& time_s, const std::string& name,
                long first_line, Recording& recording);

}  // namespace rigfit::signal
