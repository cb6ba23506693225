// Options for reading a recording whose file leaves something open.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace rigfit::signal {

/// Facts about a recording that its file does not state, or states wrongly.
struct ReadOptions {
  /// Hz, for a file without times or rate. Where the file states another rate, this one is used and
  /// the difference is noted. 0: the file's.
  double sample_rate_hz = 0;
  double time_unit_s = 0;  ///< seconds per number of the time column; 0: the file's
  char decimal = 0;        ///< decimal sign of a table, '.' or ','; 0: detected
  char separator = 0;      ///< between columns, ',', ';', tab or ' '; 0: detected
  std::string format{};    ///< one of `format_names()`; empty: detected from the content
  std::vector<std::string> variables{};  ///< arrays to take of a file that names several
  std::string sheet{};  ///< in a workbook, by name or number ("#2"); empty: the first
  /// If given, called now and then with the bytes read so far (never for MATLAB's arrays, sounds
  /// and workbooks, which are read whole). What it throws ends the reading.
  std::function<void(std::size_t)> done_with{};
};

}  // namespace rigfit::signal
