#include "signal/readers/files/number_text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>

namespace rigfit::signal {
namespace {

constexpr std::array<double, 23> kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                 1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

inline bool is_digit(char c) { return static_cast<unsigned char>(c - '0') < 10; }

/// What std::from_chars makes of `text` after the decimal sign became a point, e an exponent.
double slow_number(const char* first, const char* last, char decimal) {
  std::array<char, 64> small{};
  std::string large;
  char* copy = small.data();
  const auto size = static_cast<std::size_t>(last - first);
  if (size > small.size()) {
    large.resize(size);
    copy = large.data();
  }
  for (std::size_t k = 0; k < size; ++k) {
    const char c = first[k];
    copy[k] = c == decimal ? '.' : (c == 'd' || c == 'D') ? 'e' : c;
  }
  const char* begin = copy;
  if (size > 0 && *begin == '+') ++begin;
  double value = 0;
  const auto [end, error] = std::from_chars(begin, copy + size, value);
  (void)end;
  if (error == std::errc::result_out_of_range) {
    // from_chars does not say whether the number is too large or too small; strtod does.
    const std::string text(begin, static_cast<const char*>(copy + size));
    value = std::strtod(text.c_str(), nullptr);
  }
  return value;
}

}  // namespace

const char* parse_number(const char* p, const char* end, char decimal, double& value) {
  const char* q = p;
  const bool negative = *q == '-';
  if (negative || *q == '+') ++q;
  std::uint64_t mantissa = 0;
  const char* const digits = q;
  while (is_digit(*q)) mantissa = mantissa * 10 + static_cast<std::uint64_t>(*q++ - '0');
  std::int64_t count = q - digits, exponent = 0;
  if (*q == decimal) {
    const char* const fraction = ++q;
    if constexpr (std::endian::native == std::endian::little) {
      // Eight digits at a time: three multiplications instead of eight dependent ones.
      while (end - q >= 8) {
        std::uint64_t eight = 0;
        std::memcpy(&eight, q, 8);
        const std::uint64_t is_not_digit =
            ((eight & 0xF0F0F0F0F0F0F0F0U) |
             (((eight + 0x0606060606060606U) & 0xF0F0F0F0F0F0F0F0U) >> 4)) ^
            0x3333333333333333U;
        if (is_not_digit != 0) break;
        eight -= 0x3030303030303030U;
        eight = eight * 10 + (eight >> 8);
        eight = ((eight & 0x000000FF000000FFU) * 0x000F424000000064U +
                 ((eight >> 16) & 0x000000FF000000FFU) * 0x0000271000000001U) >>
                32;
        mantissa = mantissa * 100000000 + eight;
        q += 8;
      }
    }
    while (is_digit(*q)) mantissa = mantissa * 10 + static_cast<std::uint64_t>(*q++ - '0');
    exponent = fraction - q;
    count -= exponent;
  }
  if (count == 0) return nullptr;
  const char letter = static_cast<char>(*q | 0x20);
  if (letter == 'e' || letter == 'd') {
    const char* r = q + 1;
    const bool minus = *r == '-';
    if (minus || *r == '+') ++r;
    if (is_digit(*r)) {
      std::int64_t written = 0;
      for (; is_digit(*r); ++r) {
        if (written < 100000) written = written * 10 + (*r - '0');
      }
      exponent += minus ? -written : written;
      q = r;
    }
  }
  constexpr std::uint64_t kExact = std::uint64_t{1} << 53;
  if (count <= 19 && mantissa <= kExact && exponent >= -22 && exponent <= 22) {
    double v = static_cast<double>(mantissa);
    v = exponent < 0 ? v / kPowersOfTen[static_cast<std::size_t>(-exponent)]
                     : v * kPowersOfTen[static_cast<std::size_t>(exponent)];
    value = negative ? -v : v;
    return q;
  }
  value = slow_number(p, q, decimal);
  return q;
}

bool parse_whole_number(std::string_view text, char decimal, double& value) {
  if (text.empty()) return false;
  std::array<char, 72> small{};
  std::string large;
  char* copy = small.data();
  if (text.size() + 1 > small.size()) {
    large.resize(text.size() + 1);
    copy = large.data();
  }
  std::copy(text.begin(), text.end(), copy);
  copy[text.size()] = '\n';
  return parse_number(copy, copy + text.size() + 1, decimal, value) == copy + text.size();
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
      int written = 0;
      const char* first = text.data() + k + 1;
      const char* const last = text.data() + text.size();
      if (first < last && *first == '+') ++first;
      std::from_chars(first, last, written);
      return decimals - std::clamp(written, -400, 400);
    }
  }
  return decimals;
}

}  // namespace rigfit::signal
