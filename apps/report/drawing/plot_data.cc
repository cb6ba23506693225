#include "apps/report/drawing/plot_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

namespace rigfit::apps {
namespace {

constexpr std::size_t kDensePlot = 500;  // points of a series that need not have all digits

/// A number with the digits a plot can show; null when not finite.
void add_number(std::string& text, double value, int digits) {
  if (std::isfinite(value)) {
    fmt::format_to(std::back_inserter(text), "{:.{}g}", value, digits);
  } else {
    text += "null";
  }
}

std::string numbers(const std::vector<double>& values, int digits) {
  std::string text = "[";
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) text += ',';
    add_number(text, values[i], digits);
  }
  return text + "]";
}

/// Evenly spaced abscissae as first value, step and number.
std::string abscissae(const std::vector<double>& x) {
  const std::size_t n = x.size();
  if (n > 20) {
    const double step = (x.back() - x.front()) / static_cast<double>(n - 1);
    bool even = std::isfinite(step) && step != 0;
    for (std::size_t i = 0; even && i < n; ++i) {
      even = std::abs(x.front() + static_cast<double>(i) * step - x[i]) <= 1e-6 * std::abs(step);
    }
    if (even) return fmt::format("{{\"from\":{},\"step\":{},\"n\":{}}}", x.front(), step, n);
  }
  return numbers(x, 7);
}

/// Samples as whole numbers of a step, each less the one before: a record takes a third of the
/// room. Gaps are null. The step is a 20 000th of the range: more than a screen or a hand tells
/// apart.
std::string packed(const std::vector<double>& values) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  if (!(high > low)) return numbers(values, 4);
  const double step = (high - low) / 20000;
  std::string text = fmt::format("{{\"from\":{},\"step\":{},\"d\":[", low, step);
  long before = 0;
  bool first = true;
  for (const double v : values) {
    if (!first) text += ',';
    first = false;
    if (!std::isfinite(v)) {
      text += "null";
      continue;
    }
    const long now = std::lround((v - low) / step);
    fmt::format_to(std::back_inserter(text), "{}", now - before);
    before = now;
  }
  return text + "]}";
}

}  // namespace

std::string json_text(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string plot_data(const Plot& plot) {
  std::string text = fmt::format(
      "{{\"title\":{},\"x_label\":{},\"y_label\":{},\"log_x\":{},\"log_y\":{},\"link\":{},"
      "\"decibels\":{},\"angle\":{},\"same_axes\":{},\"marks\":[",
      json_text(plot.title), json_text(plot.x_label), json_text(plot.y_label), plot.log_x,
      plot.log_y, json_text(plot.link), plot.decibels, plot.angle, plot.same_axes);
  bool first = true;
  for (const auto& mark : plot.marks) {
    if (!std::isfinite(mark.x)) continue;
    text += fmt::format("{}{{\"x\":{},\"label\":{},\"origin\":\"{}\",\"doubtful\":{}}}",
                        first ? "" : ",", mark.x, json_text(mark.label), word_of(mark.origin),
                        mark.doubtful);
    first = false;
  }
  text += "],\"series\":[";
  for (std::size_t k = 0; k < plot.series.size(); ++k) {
    const auto& series = plot.series[k];
    const SeriesLook look = look_of(series);
    text += fmt::format(
        "{}{{\"name\":{},\"group\":{},\"origin\":\"{}\",\"shade\":{},\"line\":{},"
        "\"dash\":{},\"marker\":\"{}\",\"hollow\":{},\"x\":",
        k > 0 ? "," : "", json_text(series.name), json_text(series.group), word_of(series.origin),
        look.shade, look.line, numbers(look.dash, 3), word_of(look.marker), look.hollow);
    std::size_t same = 0;
    while (same < k && plot.series[same].x != series.x) ++same;
    text += same < k ? fmt::format("{}", same) : abscissae(series.x);
    const int digits = series.x.size() > kDensePlot ? 4 : 6;
    const bool dense = series.x.size() > kDensePlot && !plot.log_y;
    text += ",\"y\":" + (dense ? packed(series.y) : numbers(series.y, digits));
    if (!series.low.empty()) {
      text += ",\"low\":" + numbers(series.low, digits - 1);
      text += ",\"high\":" + numbers(series.high, digits - 1);
    }
    text += "}";
  }
  return text + "]}";
}

}  // namespace rigfit::apps
