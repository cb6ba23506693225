#include "apps/describe/digits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rigfit::apps {
namespace {

/// Decimals (negative: tens, hundreds) of the second digit of `std`: of 0.0996, which is 0.10, two.
int decimals_of_std(double std) {
  return 1 - static_cast<int>(std::floor(std::log10(std * (1 + 0.5e-2))));
}

std::string to_place(double value, int decimals) {
  const double unit = decimals < 0 ? std::pow(10.0, -decimals) : 1;
  const double rounded = decimals < 0 ? std::round(value / unit) * unit : value;
  const std::string text = fmt::format("{:.{}f}", rounded, std::max(0, decimals));
  const bool minus_zero = text.starts_with('-') && text.find_first_not_of("-0.") == text.npos;
  return minus_zero ? text.substr(1) : text;
}

}  // namespace

std::string value_digits(double value, double std) {
  if (!std::isfinite(value)) return "-";
  if (!(std > 0) || !std::isfinite(std)) return fmt::format("{:.6g}", value);
  const int decimals = decimals_of_std(std);
  if (decimals <= 10 && std::abs(value) < 1e9 && std < 1e9) return to_place(value, decimals);
  // So small or large that digits would be counted: an exponent, to the same place.
  const double larger = std::max(std::abs(value), std);
  const int first = static_cast<int>(std::floor(std::log10(larger)));
  return fmt::format("{:.{}e}", value, std::clamp(first + decimals, 1, 15));
}

std::string std_digits(double std) {
  if (!std::isfinite(std)) return "-";
  if (!(std > 0)) return "0";
  const int decimals = decimals_of_std(std);
  return decimals <= 10 && std < 1e9 ? to_place(std, decimals) : fmt::format("{:.1e}", std);
}

}  // namespace rigfit::apps
