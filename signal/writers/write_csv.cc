#include "signal/writers/write_csv.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace rigfit::signal {
namespace {

// Quoted when it would break the table.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char c : text) {
    if (c == '"') quoted += '"';
    quoted += c == '\n' || c == '\r' ? ' ' : c;
  }
  return quoted + "\"";
}

}  // namespace

std::string csv_text(const Recording& recording,
                     const std::vector<std::pair<std::string, std::string>>& header, int digits,
                     const std::string& axis) {
  std::string text;
  for (const auto& [key, value] : header) text += cell(key) + "," + cell(value) + "\n";
  text += axis;
  for (const auto& channel : recording.channels) {
    text += ",";
    text += cell(channel.source_unit.empty()
                     ? channel.name
                     : fmt::format("{} ({})", channel.name, channel.source_unit));
  }
  text += "\n";
  const auto out = std::back_inserter(text);
  const bool own_time = recording.time_s.size() == recording.samples();
  for (Eigen::Index i = 0; i < recording.samples(); ++i) {
    // Times of uniform sampling are written such that the rate can be read back from them.
    fmt::format_to(
        out, "{:.12g}",
        own_time && recording.time_s.size() > 0
            ? recording.time_s[i]
            : recording.start_time_s + static_cast<double>(i) / recording.sample_rate_hz);
    for (const auto& channel : recording.channels) {
      text += ',';
      const double value = (channel.samples[i] - channel.si_offset) / channel.si_per_source;
      if (std::isfinite(value)) fmt::format_to(out, "{:.{}g}", value, digits);
    }
    text += '\n';
  }
  return text;
}

}  // namespace rigfit::signal
