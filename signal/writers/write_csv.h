// Recordings as CSV that this and other tools read: a header of `key,value` lines, a line of names
// with units, a time column, then one column per channel in the channel's source unit.
#pragma once

#include "signal/recording/recording.h"

namespace rigfit::signal {

/// `header` lines stand above the table; a missing sample is an empty field. Numbers are written
/// with `digits` significant digits (17 gives back the same doubles). `axis` is the title of
/// `time_s`, which may be frequencies.
[[nodiscard]] std::string csv_text(const Recording& recording,
                                   const std::vector<std::pair<std::string, std::string>>& header,
                                   int digits = 7, const std::string& axis = "Time (s)");

}  // namespace rigfit::signal
