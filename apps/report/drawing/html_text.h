// Text and numbers as they stand in HTML.
#pragma once

#include <string>
#include <string_view>

namespace rigfit::apps {

/// &, <, >, ", ' replaced; bytes that are not UTF-8 as by the readers (signal::to_utf8), control
/// characters as blanks.
[[nodiscard]] std::string escaped(std::string_view text);

/// How many characters a UTF-8 text has.
[[nodiscard]] double characters(std::string_view text);

/// A number with so many significant digits, thin-spaced thousands left out; "–" when not finite.
[[nodiscard]] std::string shown(double value, int digits = 4);
/// A ratio as percent with sign: "+1.24 %".
[[nodiscard]] std::string shown_percent(double ratio);
/// Text of a terminal with the signs of print: "±", "−", "m²".
[[nodiscard]] std::string with_signs(std::string text);
/// A cell of text for CSV.
[[nodiscard]] std::string csv_quoted(std::string_view text);
/// "1 state", "4 states".
[[nodiscard]] std::string counted(std::size_t number, std::string_view what);
/// A relative uncertainty in percent, one digit: "0.4 %", "12 %", "less than 0.001 %".
[[nodiscard]] std::string within_percent(double ratio);

}  // namespace rigfit::apps
