#include "signal/readers/files/number_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <string>

namespace rigfit::signal {
namespace {

bool is_digit(char c) { return static_cast<unsigned char>(c - '0') < 10; }

const char* skip_digits(const char* p) {
  while (is_digit(*p)) ++p;
  return p;
}

bool is_exponent(const char* p) {
  const char letter = static_cast<char>(*p | 0x20);
  return (letter == 'e' || letter == 'd') && is_digit(p[p[1] == '-' || p[1] == '+' ? 2 : 1]);
}

/// The number from `first` on as std::from_chars wants it: a decimal point, e before the exponent.
const char* parse_copy(const char* first, char decimal, double& value) {
  const char* last = skip_digits(*first == '-' ? first + 1 : first);
  if (*last == decimal) last = skip_digits(last + 1);
  if (is_exponent(last)) last = skip_digits(last + (is_digit(last[1]) ? 1 : 2));
  std::array<char, 64> small{};
  std::string large;
  const auto size = static_cast<std::size_t>(last - first);
  if (size >= small.size()) large.resize(size + 1);
  char* const copy = large.empty() ? small.data() : large.data();
  std::transform(first, last, copy, [decimal](char c) {
    return c == decimal ? '.' : c == 'd' || c == 'D' ? 'e' : c;
  });
  const auto error = std::from_chars(copy, copy + size, value).ec;
  // from_chars does not say whether the number is too large or too small; strtod does.
  if (error == std::errc::result_out_of_range) value = std::strtod(copy, nullptr);
  return last;
}

}  // namespace

const char* parse_number(const char* p, const char* end, char decimal, double& value) {
  const bool plus = *p == '+';
  if (plus) ++p;
  const char* const digits = !plus && *p == '-' ? p + 1 : p;
  if (!is_digit(*digits) && !(*digits == decimal && is_digit(digits[1]))) return nullptr;
  if (decimal == '.') {
    const auto [behind, error] = std::from_chars(p, end, value);
    if (error == std::errc() && !is_exponent(behind)) return behind;
  }
  return parse_copy(p, decimal, value);
}

bool parse_whole_number(std::string_view text, char decimal, double& value) {
  if (text.empty()) return false;
  const std::string copy = std::string(text) + '\n';
  const char* const end = copy.data() + copy.size();
  return parse_number(copy.data(), end, decimal, value) == end - 1;
}

int printed_decimals(std::string_view text, char decimal) {
  int decimals = 0;
  bool behind = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (c == decimal) {
      behind = true;
    } else if (is_digit(c)) {
      if (behind) ++decimals;
    } else if (c == 'e' || c == 'E' || c == 'd' || c == 'D') {
      const std::size_t first = k + 1 < text.size() && text[k + 1] == '+' ? k + 2 : k + 1;
      int written = 0;
      std::from_chars(text.data() + first, text.data() + text.size(), written);
      return decimals - std::clamp(written, -400, 400);
    }
  }
  return decimals;
}

}  // namespace rigfit::signal
