#include "apps/report/drawing/html_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "apps/describe/digits.h"

namespace rigfit::apps {
namespace {

/// Length of the UTF-8 sequence at `i`, 0 when it is none.
std::size_t sequence_length(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char lead = byte(i);
  const std::size_t length = lead < 0x80                    ? 1
                             : lead >= 0xc2 && lead <= 0xdf ? 2
                             : lead >= 0xe0 && lead <= 0xef ? 3
                             : lead >= 0xf0 && lead <= 0xf4 ? 4
                                                            : 0;
  if (length == 0 || i + length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(i + k) & 0xc0) != 0x80) return 0;
  }
  return length;
}

std::string with_minus(std::string text) {
  if (text.find_first_not_of("-0.") == std::string::npos && text.starts_with('-')) text.erase(0, 1);
  if (text.starts_with('-')) text.replace(0, 1, "−");
  return text;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string result;
  result.reserve(text.size() + text.size() / 8);
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = sequence_length(text, i);
    if (length == 0) {
      result += "\xef\xbf\xbd";
      ++i;
      continue;
    }
    if (length > 1) {
      result += text.substr(i, length);
      i += length;
      continue;
    }
    switch (const char c = text[i++]) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t') result += c;
    }
  }
  return result;
}

std::string shown(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  if (value == 0) return "0";
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
  std::string text = exponent >= -4 && exponent < 7
                         ? fmt::format("{:.{}f}", value, std::max(0, digits - 1 - exponent))
                         : fmt::format("{:.{}e}", value, digits - 1);
  if (text.starts_with('-')) text.replace(0, 1, "−");
  return text;
}

std::string shown_percent(double ratio) {
  if (!std::isfinite(ratio)) return "–";
  const double percent = 100 * ratio;
  std::string text = std::abs(percent) < 10 ? fmt::format("{:.2f}", std::abs(percent))
                                            : fmt::format("{:.1f}", std::abs(percent));
  const bool zero = text.find_first_not_of("0.") == std::string::npos;
  return (zero ? "" : ratio < 0 ? "−" : "+") + text + " %";
}

std::string shown_estimate(double value, double std, int digits) {
  if (!std::isfinite(value)) return "–";
  if (!(std::isfinite(std) && std > 0)) return shown(value, digits);
  return with_minus(value_digits(value, std)) + " ± " + std_digits(std);
}

std::string csv_quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

std::string counted(std::size_t number, std::string_view what) {
  return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

std::string shown_bound(double value, double std) {
  if (!std::isfinite(value) || !(std::isfinite(std) && std > 0)) return shown(value);
  return with_minus(value_digits(value, std));
}

std::string within_percent(double ratio) {
  if (100 * ratio < 0.001) return "less than 0.001 %";
  const double percent = 100 * ratio;
  return fmt::format(
      "{:.{}f} %", percent,
      percent < 9.5 ? -static_cast<int>(std::floor(std::log10(percent * 1.005))) : 0);
}

}  // namespace rigfit::apps
