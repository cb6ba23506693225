// Numbers in text, correctly rounded, by std::from_chars; decimal commas and exponents by d through
// a copy.
#pragma once

#include <string_view>

namespace rigfit::signal {

/// Parses the number at `p`; `decimal` is '.' or ','. The text must hold a character that cannot
/// belong to a number (such as a line's end) at or before `end - 1`. Returns the first character
/// after the number, or nullptr when there is none at `p`. Accepts a leading '+' and exponents by
/// e, E, d, D; not "inf", "nan", hexadecimal. Beyond the range of double gives +-inf (or 0).
[[nodiscard]] const char* parse_number(const char* p, const char* end, char decimal, double& value);

/// The whole of `text` (no blanks around) as a number.
[[nodiscard]] bool parse_whole_number(std::string_view text, char decimal, double& value);

/// Digits behind the decimal sign less the exponent: 3 for "0.250", 7 for "1.50E-5"; the printed
/// resolution is 10^-decimals.
[[nodiscard]] int printed_decimals(std::string_view text, char decimal);

}  // namespace rigfit::signal
