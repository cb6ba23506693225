// Text as lines, fields and numbers. Numbers are read by std::from_chars, correctly rounded;
// decimal commas and exponents by d go through a copy.
#pragma once

#include "signal/recording/recording.h"

namespace rigfit::signal {

/// How a table's columns and numbers are written.
struct CsvDialect {
  char separator = ',';  ///< ',', ';', '\t', or ' ' for any run of blanks and tabs
  char decimal = '.';    ///< '.' or ','
};

enum class FieldKind {
  empty,
  number,
  missing,  ///< a word for no value: NaN, N/A, null, --, Inf, OVL ...
  clock,    ///< 12:34:56.789, with or without a date in front
  text,
};

/// A field without its blanks and quotes; `text` may be a view of the line.
struct CsvField {
  std::string_view text;
  bool quoted = false;
};

/// Fields of a line without its end. Doubled quotes inside a quoted field are kept as they are.
void split_fields(std::string_view line, const CsvDialect& dialect, std::vector<CsvField>& fields);

[[nodiscard]] FieldKind kind_of(std::string_view field, char decimal);

/// A line of text, its first 4 MiB (300,000 columns), as fields with what each is.
struct CsvRow {
  std::vector<CsvField> fields;
  std::vector<FieldKind> kinds;
  long numbers = 0, words = 0;

  CsvRow(std::string_view line, const CsvDialect& dialect);
  [[nodiscard]] FieldKind kind(std::size_t column) const {
    return column < kinds.size() ? kinds[column] : FieldKind::empty;
  }
  /// A line that can be one of the table: at least a number, and words only where there are fewer
  /// of them than numbers.
  [[nodiscard]] bool is_good() const { return numbers > 0 && words <= numbers; }
};
[[nodiscard]] std::vector<CsvField> without_empty_end(std::vector<CsvField> fields);

/// Words that loggers write where they have no value.
[[nodiscard]] bool is_missing_word(std::string_view field);

/// Seconds since midnight, or since 1970-01-01 where there is a date (ISO "2026-04-09", also with
/// '/' and '.', or day first; in UTC where it has a zone); `decimals`: digits behind the seconds.
/// False when it is no time.
[[nodiscard]] bool parse_clock(std::string_view field, double& seconds, int& decimals);

/// Characters of the number that `text` begins with; 0: it begins with none. `decimal` is '.' or
/// ','. Accepts a leading '+' and exponents by e, E, d, D; not "inf", "nan", hexadecimal. Beyond
/// the range of double gives +-inf (or 0).
[[nodiscard]] std::size_t parse_number(std::string_view text, char decimal, double& value);

/// The whole of `text` (no blanks around) as a number, also with its thousands parted ("1,234.5").
[[nodiscard]] bool parse_whole_number(std::string_view text, char decimal, double& value);

/// Digits behind the decimal sign less the exponent: 3 for "0.250", 7 for "1.50E-5"; the printed
/// resolution is 10^-decimals.
[[nodiscard]] int printed_decimals(std::string_view text, char decimal);

/// 1-based number of the line that `offset` is in.
[[nodiscard]] long line_number(std::string_view bytes, std::size_t offset);

/// An error about `value`, a part of `bytes`, with its line and column; where it is empty, with the
/// line alone.
[[nodiscard]] RecordingError text_error(std::string_view bytes, const std::string& file,
                                        std::string_view value, std::string problem,
                                        std::string remedy, const std::string& channel = "");

/// Takes the first line off `rest` and returns it without its end; of empty text, empty.
std::string_view take_line(std::string_view& rest);

/// Text without its byte-order mark. Throws RecordingError for UTF-16 and binary data.
[[nodiscard]] std::string_view text_without_mark(std::string_view bytes, const std::string& file);

}  // namespace rigfit::signal
