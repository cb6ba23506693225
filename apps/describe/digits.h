// Numbers on a terminal with the digits that are known: two of the standard uncertainty, and the
// value to the same place, both without exponents where that stays readable.
#pragma once

#include <string>

namespace rigfit::apps {

/// "205190" for 205188 known to 340; six digits where `std` is not a positive number; "-" for NaN.
[[nodiscard]] std::string value_digits(double value, double std);

/// Two digits: "340", "0.0041", "0.00000077"; "0" for zero, "-" for what is not finite.
[[nodiscard]] std::string std_digits(double std);

}  // namespace rigfit::apps
