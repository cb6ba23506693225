// What stands above a table of numbers: names, units, ranges and a sample rate, in rows with or
// without a label in front.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "signal/readers/csv/csv_column.h"

namespace rigfit::signal {

/// Fills names, units, ranges and the stated rate of `layout`, whose dialect and columns are known.
/// Throws RecordingError when the titles show that the columns were split wrongly.
void read_csv_header(const std::vector<std::string_view>& lines, const std::string& file,
                     CsvLayout& layout);

/// "Sampling Rate(Hz)" 50, "Sample interval [ms]" 2, "fs" 1000: the rate, 0 when the label is no
/// such thing. The unit may stand in the label or behind the number.
[[nodiscard]] double rate_from_label(std::string_view label, std::string_view value, char decimal);

}  // namespace rigfit::signal
