// One line of a table of text as fields, and what a field holds.
#pragma once

#include <string>
#include <string_view>
#include <vector>

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

/// Words that loggers write where they have no value.
[[nodiscard]] bool is_missing_word(std::string_view field);

/// Seconds since midnight, or since 1970-01-01 where there is a date (ISO "2026-04-09", also with
/// '/' and '.', or day first); `decimals`: digits behind the seconds. False when it is no time.
[[nodiscard]] bool parse_clock(std::string_view field, double& seconds, int& decimals);

[[nodiscard]] std::string_view trim_blanks(std::string_view s);
[[nodiscard]] std::string lower_case(std::string_view s);
/// Whether "|a|b|" lists the word.
[[nodiscard]] bool is_listed(std::string_view list, const std::string& word);

}  // namespace rigfit::signal
