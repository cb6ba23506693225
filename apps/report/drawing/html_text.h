// Text and numbers as they stand in HTML.
#pragma once

#include <string>
#include <string_view>

namespace rigfit::apps {

/// &, <, >, ", ' replaced; bytes that are not UTF-8 as by the readers (signal::to_utf8), control
/// characters as blanks.
[[nodiscard]] std::string escaped(std::string_view text);

/// A number with so many significant digits, thin-spaced thousands left out; "–" when not finite.
[[nodiscard]] std::string shown(double value, int digits = 4);
/// A ratio as percent with sign: "+1.24 %".
[[nodiscard]] std::string shown_percent(double ratio);
/// A value with its standard uncertainty, rounded to two digits of the latter: "0.4948 ± 0.0012",
/// "205190 ± 340", as everywhere (apps/describe/sheet.h).
[[nodiscard]] std::string shown_estimate(double value, double std, int digits = 4);
/// A cell of text for CSV.
[[nodiscard]] std::string csv_quoted(std::string_view text);
/// "1 state", "4 states".
[[nodiscard]] std::string counted(std::size_t number, std::string_view what);
/// A bound of an interval, to the decimals that `shown_estimate` gives the value.
[[nodiscard]] std::string shown_bound(double value, double std);

/// A relative uncertainty in percent, one digit: "0.4 %", "12 %", "less than 0.001 %".
[[nodiscard]] std::string within_percent(double ratio);

}  // namespace rigfit::apps
