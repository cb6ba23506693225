// How a table of text is laid out: separator, decimal sign, where its numbers begin, what each
// column is called and holds. Found from the text itself, by looking at lines all over the file.
//
// Names, units, ranges and a sample rate stand above the numbers, in rows with or without a label
// in front ("Sampling Rate(Hz)" 50, "Sample interval [ms]" 2, "Einheit;V"). The comma in a table of
// whole numbers ("1,5") may part columns or be the decimal sign: titles, leading zeros behind it
// ("1,05") and signs ("1,-5") decide, or the table is refused with the question.
#pragma once

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
  /// Most digits behind the decimal sign in the last lines looked at that hold a number; 400: none.
  int decimals = 400;

  std::string unread{};  ///< a text of it that begins as a number, UTF-8; empty: none

  [[nodiscard]] bool has_data() const {
    return kind == ColumnKind::numbers || kind == ColumnKind::clock;
  }
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
  bool more_titles = false;      ///< than columns
  std::string unmatched_titles;  ///< a line of titles that does not fit the columns; empty: none
  std::string heading;           ///< the header's lines of text, UTF-8, lower case, its first 4 kB
};

/// Throws RecordingError when there is no table of numbers in the text, and when its commas can be
/// read in two ways and `options` do not say. `file` is for messages.
[[nodiscard]] CsvLayout find_csv_layout(std::string_view bytes, const std::string& file,
                                        const ReadOptions& options = {});

/// Sets `decimals` of the columns of a layout that a reader made itself.
void find_csv_decimals(std::string_view bytes, CsvLayout& layout);

/// Whether a column of this name holds times.
[[nodiscard]] bool is_time_name(const std::string& name);

}  // namespace rigfit::signal
