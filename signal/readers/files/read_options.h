// What a person adds to a recording that its file does not say.
#pragma once

#include <string>
#include <vector>

namespace rigfit::signal {

/// What the person who reads a recording knows of it.
struct ReadOptions {
  /// Hz; for a file without times or rate. Where the file says otherwise, this is taken and the
  /// disagreement noted. 0: as the file says.
  double sample_rate_hz = 0;
  double time_unit_s = 0;  ///< seconds per number of the time column; 0: as the file says
  char decimal = 0;        ///< decimal sign of a table, '.' or ','; 0: found
  char separator = 0;      ///< between columns, ',', ';', tab or ' '; 0: found
  std::string format;      ///< one of `format_names()`; empty: by the content
  std::vector<std::string> variables;  ///< arrays to take of a file that names several; empty: all
};

}  // namespace rigfit::signal
