#include "signal/recording/clipping.h"

#include "signal/estimation/robust.h"

namespace rigfit::signal {

namespace {

using Samples = Ref<const VectorXd>;

/// Samples for which the signal keeps the value that it takes when it leaves `at` in a direction.
double next_step(const Samples& channel, Index at, Index direction) {
  double length = 0;
  for (Index k = at + direction; k >= 0 && k < channel.size(); k += direction, ++length) {
    if (channel[k] != channel[at + direction]) return length;
  }
  return static_cast<double>(channel.size());  // the record ends there: nothing can be said
}

/// Whether the equal samples first..last at an extreme are clipped; `quantum`: smallest change
/// between neighbours.
bool is_flat_top(const Samples& channel, double quantum, Index first, Index last) {
  double entry = 0;
  if (first > 0) entry = std::max(entry, std::abs(channel[first - 1] - channel[first]));
  if (last + 1 < channel.size()) {
    entry = std::max(entry, std::abs(channel[last + 1] - channel[last]));
  }
  const auto length = static_cast<double>(last - first + 1);
  if (length < 3) return length == 2 && entry > 100 * quantum;
  const double held = std::max(next_step(channel, first, -1), next_step(channel, last, 1));
  return entry > 3 * quantum ? length > 2 * held : length >= 10 && held < 0.1 * length;
}

}  // namespace

bool ClippedSamples::any(Index first_sample, Index last_sample) const {
  return std::any_of(at.begin() + first_sample, at.begin() + last_sample + 1,
                     [](bool is_clipped) { return is_clipped; });
}

ClippedSamples clipped_samples(const Samples& channel, double nominal_range) {
  const Index n = channel.size();
  ClippedSamples result;
  result.at.assign(static_cast<std::size_t>(n), false);
  std::vector<double> finite = finite_values(channel);
  if (finite.empty()) return result;
  double quantum = std::numeric_limits<double>::infinity();
  for (Index k = 1; k < n; ++k) {
    const double change = std::abs(channel[k] - channel[k - 1]);
    if (change > 0 && std::isfinite(change)) quantum = std::min(quantum, change);
  }
  const auto [low, high] = std::ranges::minmax(finite);
  const double rest = median(std::move(finite));
  for (const double rail : {high, low}) {
    if (!(std::abs(rail - rest) >= 0.1 * (high - low)) || high == low) continue;
    bool clipped = false;
    for (Index k = 0, end = 0; k < n && !clipped; k = end + 1) {
      end = k;
      if (channel[k] != rail) continue;
      while (end + 1 < n && channel[end + 1] == rail) ++end;
      clipped = is_flat_top(channel, quantum, k, end);
    }
    if (clipped) result.levels.push_back(rail);
  }
  constexpr double kShareOfRange = 0.999;
  for (Index k = 0; k < n; ++k) {
    const bool at_rail = std::ranges::find(result.levels, channel[k]) != result.levels.end();
    if (!at_rail && !(nominal_range > 0 && std::abs(channel[k]) >= kShareOfRange * nominal_range)) {
      continue;
    }
    result.at[static_cast<std::size_t>(k)] = true;
    if (result.count++ == 0) result.first = k;
  }
  return result;
}

}  // namespace rigfit::signal
