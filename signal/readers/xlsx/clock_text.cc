#include "signal/readers/xlsx/clock_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace rigfit::signal {
namespace {

constexpr double kSecondsOfDay = 86400;
constexpr int kLongestHours = 1000;   // the reader of times takes three digits of hours
constexpr long k1900To1970 = 25569;   // days from 1899-12-30 to 1970-01-01
constexpr long k1904To1970 = 24107;   // days from 1904-01-01
constexpr long kFirstCommonDay = 61;  // 1900-03-01
constexpr double kDayAfter9999 = 2958466;

}  // namespace

std::optional<std::string> clock_text(double days, CellFormat format, bool from_1904) {
  if (!(days >= 0) || days >= kDayAfter9999) return std::nullopt;
  // A quarter of the last digit's step is the number's own rounding.
  const double step =
      kSecondsOfDay * (std::nextafter(days, std::numeric_limits<double>::infinity()) - days);
  const int digits = std::clamp(static_cast<int>(std::floor(-std::log10(4 * step))), 0, 9);
  const double scale = std::pow(10.0, digits);
  const auto ticks = std::llround(days * kSecondsOfDay * scale);
  const auto per_second = static_cast<long long>(scale);
  const long long seconds = ticks / per_second;
  const auto clock = [&](long long hours) {
    const std::string text =
        fmt::format("{:02}:{:02}:{:02}", hours, seconds / 60 % 60, seconds % 60);
    return digits == 0 ? text : fmt::format("{}.{:0{}}", text, ticks % per_second, digits);
  };
  if (format == CellFormat::time && seconds / 3600 < kLongestHours) return clock(seconds / 3600);
  const auto day = static_cast<long>(seconds / 86400);
  if (!from_1904 && day < kFirstCommonDay) return std::nullopt;
  const std::chrono::year_month_day date{
      std::chrono::sys_days{std::chrono::days{day - (from_1904 ? k1904To1970 : k1900To1970)}}};
  const std::string text =
      fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()),
                  static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
  if (format == CellFormat::date && ticks % (86400 * per_second) == 0) return text;
  return text + " " + clock(seconds / 3600 % 24);
}

}  // namespace rigfit::signal
