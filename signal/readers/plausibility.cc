#include "signal/readers/plausibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rigfit::signal {
namespace {

struct Bounds {
  double least = 0, most = std::numeric_limits<double>::infinity();
};

Bounds bounds_of(const Channel& channel, bool by_voltage) {
  switch (channel.quantity) {
    case Quantity::acceleration:
      return {1e-6, 1e5};
    case Quantity::force:
      return by_voltage ? Bounds{1e-3, 1e5} : Bounds{0, 1e8};
    case Quantity::displacement:
      return {0, 1000};
    case Quantity::velocity:
      return {0, 1e4};
    default:
      return {};
  }
}

}  // namespace

std::optional<std::string> implausible_values(const Channel& channel, bool by_voltage) {
  const Bounds bounds = bounds_of(channel, by_voltage);
  double largest = 0;
  for (const double x : channel.samples) {
    if (std::isfinite(x)) largest = std::max(largest, std::abs(x));
  }
  const bool high = largest > bounds.most;
  if (!(largest > 0) || (!high && largest >= bounds.least)) return std::nullopt;
  std::string text = by_voltage ? "Check the sensitivity"
                                : fmt::format("Check its unit (\"{}\" in the file) and scale",
                                              channel.source_unit);
  text += fmt::format(": it reaches {:.3g} {}, {} than such a channel measures", largest,
                      channel.unit, high ? "more" : "less");
  if (channel.quantity == Quantity::acceleration) {
    text += high ? fmt::format(" ({:.0f} g)", largest / 9.80665)
                 : fmt::format(" ({:.2g} g)", largest / 9.80665);
  }
  if (by_voltage) {
    text += high ? "; is the sensitivity in V and not in mV, or are the file's numbers mV and not "
                   "V? Each makes a factor of a thousand"
                 : "; is the sensitivity in mV and not in V? That makes a factor of a thousand";
  }
  return text;
}

}  // namespace rigfit::signal
