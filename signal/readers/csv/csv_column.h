// Columns of a text table as they are found (csv_layout.h).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/files/read_options.h"

namespace rigfit::signal {

enum class ColumnKind {
  numbers,
  clock,  ///< times of day
  text,   ///< words in most lines
  empty,  ///< nothing, or now and then something
};

struct CsvColumn {
  std::string name;  ///< UTF-8; empty: the file gives none
  std::string unit;  ///< as written, UTF-8; empty: none
  double range = 0;  ///< full scale as written in the header, in `unit`; 0: none
  ColumnKind kind = ColumnKind::numbers;
  double filled = 0;  ///< share of the lines looked at that hold a number or a word for none
};

struct CsvLayout {
  CsvDialect dialect;
  std::vector<CsvColumn> columns;
  std::size_t body = 0;       ///< offset of the first line of numbers
  long body_line = 1;         ///< its 1-based number
  double stated_rate_hz = 0;  ///< by the header; 0: none
  long rate_line = 0;         ///< where
  std::string rate_text;      ///< as written
  bool has_names = false;
  bool has_points = false;       ///< a decimal point stands in some number
  std::string unmatched_titles;  ///< a line of titles that does not fit the columns; empty: none
  std::string heading;           ///< the header's lines of text, UTF-8, lower case, its first 4 kB
};

}  // namespace rigfit::signal
