#include <algorithm>
#include <array>
#include <cctype>
#include <pugixml.hpp>

#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

// Windows-1252 0x80..0x9F as Unicode; 0: not assigned (becomes the replacement character).
constexpr std::array<wchar_t, 32> kWindows1252 = {
    0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021, 0x02C6, 0x2030, 0x0160,
    0x2039, 0x0152, 0,      0x017D, 0,      0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022,
    0x2013, 0x2014, 0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178};

bool is_surrogate(wchar_t c) { return c >= 0xD800 && c < 0xE000; }

}  // namespace

std::string to_utf8(std::string_view bytes) {
  std::string out(bytes);
  std::replace_if(
      out.begin(), out.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
  std::wstring wide = pugi::as_wide(out);
  const bool valid =
      pugi::as_utf8(wide.c_str()) == out &&
      std::ranges::none_of(wide, [](wchar_t c) { return is_surrogate(c) || c > 0x10FFFF; });
  if (valid) return out;
  wide.clear();
  for (const char c : out) {
    const auto code = static_cast<unsigned char>(c);
    const wchar_t mapped = code < 0x80 || code >= 0xA0 ? code : kWindows1252[code - 0x80];
    wide += mapped == 0 ? 0xFFFD : mapped;
  }
  return pugi::as_utf8(wide.c_str());
}

std::string_view trim_blanks(std::string_view s) {
  s.remove_prefix(std::min(s.find_first_not_of(" \t\r"), s.size()));
  return s.substr(0, s.find_last_not_of(" \t\r") + 1);
}

bool is_listed(std::string_view list, const std::string& word) {
  return word.find('|') == std::string::npos &&
         list.find("|" + word + "|") != std::string_view::npos;
}

std::string lower_case(std::string_view s) {
  std::string out(s);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

std::string utf16_to_utf8(std::string_view bytes, bool little) {
  std::wstring wide;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const auto low = static_cast<unsigned char>(bytes[little ? i : i + 1]);
    const auto high = static_cast<unsigned char>(bytes[little ? i + 1 : i]);
    const wchar_t code = high << 8 | low;
    wide += is_surrogate(code) ? L'?' : code;
  }
  return pugi::as_utf8(wide);
}

}  // namespace rigfit::signal
