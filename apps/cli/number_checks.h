// What the command line asks of numbers: as CLI11's own checks, which let NaN pass and name limits
// with 300 digits.
#pragma once

#include <CLI/CLI.hpp>

namespace rigfit::apps {

/// Finite and greater than zero.
[[nodiscard]] CLI::Validator positive_number();
/// Finite and not below zero.
[[nodiscard]] CLI::Validator not_negative_number();
/// From `low` to `high`, both included.
[[nodiscard]] CLI::Validator number_within(double low, double high);

}  // namespace rigfit::apps
