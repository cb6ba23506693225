#include "signal/recording/clipping.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "signal/estimation/robust.h"

namespace rigfit::signal {
using Eigen::Index;

namespace {

/// Samples for which the signal keeps the value that it takes when it leaves `at` in a direction.
double next_step(const Eigen::Ref<const Eigen::VectorXd>& channel, Index at, Index direction) {
  double length = 0;
  for (Index k = at + direction; k >= 0 && k < channel.size(); k += direction, ++length) {
    if (channel[k] != channel[at + direction]) return length;
  }
  return static_cast<double>(channel.size());  // the record ends there: nothing can be said
}

}  // namespace

ClipLevels clip_levels(const Eigen::Ref<const Eigen::VectorXd>& channel) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  ClipLevels levels{kInfinity, -kInfinity, kInfinity};
  double previous = std::numeric_limits<double>::quiet_NaN();
  for (const double value : channel) {
    if (std::isfinite(value)) {
      levels.low = std::min(levels.low, value);
      levels.high = std::max(levels.high, value);
      const double change = std::abs(value - previous);
      if (change > 0) levels.step = std::min(levels.step, change);
    }
    previous = value;
  }
  if (!(levels.high >= levels.low)) return {};
  if (!std::isfinite(levels.step)) levels.step = 0;
  return levels;
}

bool is_clipped(const Eigen::Ref<const Eigen::VectorXd>& channel, const ClipLevels& levels,
                double rest, Index first, Index last, double nominal_range) {
  const double span = levels.high - levels.low;
  if (!(span > 0)) return false;
  for (Index k = first; k <= last; ++k) {
    const double value = channel[k];
    if (nominal_range > 0 && std::abs(value) >= 0.9999 * nominal_range) return true;
    if ((value != levels.high && value != levels.low) || std::abs(value - rest) < 0.1 * span) {
      continue;
    }
    Index end = k;
    while (end < last && channel[end + 1] == value) ++end;
    double entry = 0;
    if (k > 0) entry = std::max(entry, std::abs(channel[k - 1] - value));
    if (end + 1 < channel.size()) entry = std::max(entry, std::abs(channel[end + 1] - value));
    if (end - k + 1 == 2 && entry > 100 * levels.step) return true;
    if (end - k + 1 >= 3) {
      if (entry > 3 * levels.step) return true;
      const Index length = end - k + 1;
      if (length >= 10 && next_step(channel, k, -1) < 0.1 * static_cast<double>(length) &&
          next_step(channel, end, 1) < 0.1 * static_cast<double>(length)) {
        return true;
      }
    }
    k = end;
  }
  return false;
}

ClippedSamples clipped_samples(const Eigen::Ref<const Eigen::VectorXd>& channel,
                               double nominal_range) {
  const Index n = channel.size();
  ClippedSamples result;
  result.at.assign(static_cast<std::size_t>(n), false);
  const auto mark = [&](Index k) {
    if (result.at[static_cast<std::size_t>(k)]) return;
    result.at[static_cast<std::size_t>(k)] = true;
    if (result.count++ == 0 || k < result.first) result.first = k;
  };
  std::vector<double> finite;
  std::ranges::copy_if(channel, std::back_inserter(finite),
                       [](double x) { return std::isfinite(x); });
  if (finite.empty()) return result;
  const double rest = median(std::move(finite));
  const ClipLevels levels = clip_levels(channel);
  for (const double rail : {levels.high, levels.low}) {
    bool clipped = false;
    for (Index k = 0; k < n && !clipped; ++k) {
      if (channel[k] != rail) continue;
      Index end = k;
      while (end + 1 < n && channel[end + 1] == rail) ++end;
      clipped = is_clipped(channel, levels, rest, k, end);
      k = end;
    }
    if (!clipped) continue;
    result.levels.push_back(rail);
    for (Index k = 0; k < n; ++k) {
      if (channel[k] == rail) mark(k);
    }
  }
  constexpr double kShareOfRange = 0.999;
  for (Index k = 0; k < n && nominal_range > 0; ++k) {
    if (std::abs(channel[k]) >= kShareOfRange * nominal_range) mark(k);
  }
  return result;
}

}  // namespace rigfit::signal
