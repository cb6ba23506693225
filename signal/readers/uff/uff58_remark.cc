#include "signal/readers/uff/uff58_remark.h"

#include <cmath>

#include "signal/readers/files/number_text.h"

namespace rigfit::signal {

std::map<std::string, std::string> parse_uff58_remark(std::string_view line) {
  std::map<std::string, std::string> out;
  constexpr std::string_view kMark = "rigfit ";
  if (line.substr(0, kMark.size()) != kMark) return out;
  line.remove_prefix(kMark.size());
  while (!line.empty()) {
    const std::size_t end = std::min(line.find(' '), line.size());
    const auto word = line.substr(0, end);
    const std::size_t sign = word.find('=');
    if (sign != std::string_view::npos) {
      out.emplace(std::string(word.substr(0, sign)), std::string(word.substr(sign + 1)));
    }
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return out;
}

double remark_number(const std::map<std::string, std::string>& remark, const std::string& key,
                     double fallback) {
  const auto entry = remark.find(key);
  double value = 0;
  if (entry == remark.end() || !parse_whole_number(entry->second, '.', value) ||
      !std::isfinite(value)) {
    return fallback;
  }
  return value;
}

}  // namespace rigfit::signal
