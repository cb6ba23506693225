#include "apps/report/drawing/html_text.h"

#include "apps/describe/standard.h"
#include "signal/recording/units.h"

namespace rigfit::apps {
namespace {

std::string with_minus(std::string text) {
  if (text.find_first_not_of("-0.") == std::string::npos && text.starts_with('-')) text.erase(0, 1);
  if (text.starts_with('-')) text.replace(0, 1, "−");
  return text;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : signal::to_utf8(text)) {
    const auto at = std::string_view("&<>\"'").find(c);
    static constexpr std::array<const char*, 5> kWritten{"&amp;", "&lt;", "&gt;", "&quot;",
                                                         "&#39;"};
    at == std::string_view::npos ? result += c : result += kWritten[at];
  }
  return result;
}

double characters(std::string_view text) {
  return static_cast<double>(std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U; }));
}

std::string shown(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  if (value == 0) return "0";
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
  return with_minus(exponent >= -4 && exponent < 7
                        ? fmt::format("{:.{}f}", value, std::max(0, digits - 1 - exponent))
                        : fmt::format("{:.{}e}", value, digits - 1));
}

std::string shown_percent(double ratio) {
  if (!std::isfinite(ratio)) return "–";
  const double percent = 100 * ratio;
  const std::string text =
      fmt::format("{:.{}f}", std::abs(percent), std::abs(percent) < 10 ? 2 : 1);
  const bool zero = text.find_first_not_of("0.") == std::string::npos;
  return (zero ? "" : ratio < 0 ? "−" : "+") + text + " %";
}

std::string with_signs(std::string text) {
  if (text == "-") return "–";
  if (text.starts_with('-')) text.replace(0, 1, "−");
  for (const auto& [plain, written] :
       {std::pair{"+-", "±"}, std::pair{" m2", " m²"}, std::pair{"chi2", "χ²"}}) {
    if (const auto at = text.find(plain); at != std::string::npos) {
      text.replace(at, std::string_view(plain).size(), written);
    }
  }
  return text;
}

std::string csv_quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

std::string counted(std::size_t number, std::string_view what) {
  return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

std::string within_percent(double ratio) {
  if (100 * ratio < 0.001) return "less than 0.001 %";
  const double percent = 100 * ratio;
  return fmt::format(
      "{:.{}f} %", percent,
      percent < 9.5 ? -static_cast<int>(std::floor(std::log10(percent * 1.005))) : 0);
}

}  // namespace rigfit::apps
