#include "ident/campaign/single_tests/decay_campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "ident/campaign/single_tests/rate_uncertainty.h"
#include "signal/estimation/groups.h"
#include "signal/recording/recording_error.h"

namespace rigfit::ident {
namespace {

using Eigen::Index;

Index sample_at(const signal::Recording& recording, double time_s, bool up) {
  const double j = (time_s - recording.start_time_s) * recording.sample_rate_hz;
  const auto n = static_cast<double>(recording.samples());
  // Times as printed are rounded: a millionth of a sample past one is that one.
  return static_cast<Index>(
      std::clamp(up ? std::ceil(j - 1e-6) : std::floor(j + 1e-6) + 1, 0.0, n));
}

/// The mode of another decay that is this one: the nearest within 5 % of its frequency.
const signal::DecayMode* same_mode(const signal::DecayMode& mode,
                                   const signal::DecayResult& other) {
  const signal::DecayMode* best = nullptr;
  double least = 0.05 * mode.frequency_hz.value;
  for (const auto& one : other.modes) {
    const double apart = std::abs(one.frequency_hz.value - mode.frequency_hz.value);
    if (apart < least && !one.doubtful) least = apart, best = &one;
  }
  return best;
}

/// Pools a quantity of modes of several decays; returns its scatter between them.
double pool(const std::vector<const signal::DecayMode*>& modes,
            signal::Estimate signal::DecayMode::*quantity, signal::Estimate& mean,
            signal::Interval& interval_95) {
  std::vector<double> values, variances;
  for (const auto* mode : modes) {
    values.push_back((mode->*quantity).value);
    variances.push_back((mode->*quantity).std * (mode->*quantity).std);
  }
  const signal::GroupMean effects = signal::mean_over_groups(values, variances);
  mean = {effects.mean, std::sqrt(effects.variance)};
  const double half = signal::coverage_factor(0.95, effects.degrees) * mean.std;
  interval_95 = {mean.value - half, mean.value + half};
  return std::sqrt(effects.between_variance);
}

std::vector<PooledMode> pooled(const ChannelDecays& channel) {
  std::vector<PooledMode> all;
  for (const auto& mode : channel.strongest.modes) {
    std::vector<const signal::DecayMode*> modes;
    for (const auto& decay : channel.decays) {
      const auto* same = decay.fitted ? same_mode(mode, *decay.result) : nullptr;
      if (same && same->frequency_hz.std > 0 && same->damping_ratio.std > 0) modes.push_back(same);
    }
    if (modes.empty()) continue;
    PooledMode& one = all.emplace_back();
    one.decays = modes.size();
    one.frequency_scatter_hz = pool(modes, &signal::DecayMode::frequency_hz, one.frequency_hz,
                                    one.frequency_interval_95_hz);
    one.damping_ratio_scatter = pool(modes, &signal::DecayMode::damping_ratio, one.damping_ratio,
                                     one.damping_ratio_interval_95);
    one.damping_ratio_interval_95.low = std::max(0.0, one.damping_ratio_interval_95.low);
  }
  return all;
}

/// The uncertainty of the rate, common to all frequencies of a recording.
void widen_by_rate(double relative_std, ChannelDecays& found) {
  if (!(relative_std > 0)) return;
  if (!found.strongest.modes.empty()) {
    tell_rate(relative_std, found.strongest.modes.front().frequency_hz, found.channel,
              found.findings);
  }
  const auto widen = [&](signal::DecayResult& decay) {
    for (auto& mode : decay.modes) {
      add_rate_uncertainty(relative_std, mode.frequency_hz, &mode.frequency_interval_95_hz);
      add_rate_uncertainty(relative_std, mode.damped_frequency_hz);
    }
  };
  widen(found.strongest);
  for (auto& decay : found.decays) {
    if (decay.result) widen(*decay.result);
  }
  for (auto& mode : found.pooled) {
    add_rate_uncertainty(relative_std, mode.frequency_hz, &mode.frequency_interval_95_hz);
  }
}

/// The decays of a channel between two samples.
ChannelDecays channel_decays(const signal::Recording& recording, const signal::Channel& channel,
                             const DecayTestOptions& options, Index from, Index to) {
  const double rate = recording.sample_rate_hz;
  ChannelDecays found;
  found.channel = channel.name, found.unit = channel.unit, found.sample_rate_hz = rate;
  found.start_time_s = recording.start_time_s + static_cast<double>(from) / rate;
  found.samples = channel.samples.segment(from, to - from);
  const auto time = [&](Index sample) {
    return found.start_time_s + static_cast<double>(sample) / rate;
  };
  signal::DecayOptions decay = options.decay;
  decay.start_time_s = found.start_time_s;
  if (options.start_s) decay.choose_window = decay.trim_start = false;
  auto& strongest = found.strongest;
  strongest = signal::estimate_decay(found.samples, rate, decay);
  found.start_s = time(strongest.start), found.end_s = time(strongest.end - 1);
  add_notes(strongest.notes, found.findings, found.channel);
  if (!strongest.refusal_code.empty()) {
    found.findings.push_back({strongest.refusal_code, strongest.refusal, found.channel, true});
  }
  decay.choose_window = false;
  for (std::size_t k = 0; k < strongest.decays.size(); ++k) {
    const auto& window = strongest.decays[k];
    FoundDecay one{time(window.start), time(window.end - 1), false, {}};
    if (k == strongest.fitted_decay) {
      one = {found.start_s, found.end_s, strongest.refusal_code.empty(), {}};
      if (options.each) one.result = strongest;
    } else if (options.each) {
      decay.start_time_s = one.start_s;
      one.result = signal::estimate_decay(
          found.samples.segment(window.start, window.end - window.start), rate, decay);
      const std::string where = fmt::format("{} at {:.6g} s", found.channel, one.start_s);
      one.fitted = one.result->refusal_code.empty();
      if (one.fitted) {
        one.start_s = time(window.start + one.result->start);
        one.end_s = time(window.start + one.result->end - 1);
      } else {
        found.findings.push_back(
            {one.result->refusal_code, "this decay is left out: " + one.result->refusal, where});
      }
      add_notes(one.result->notes, found.findings, where);
    }
    found.decays.push_back(std::move(one));
  }
  if (options.each) found.pooled = pooled(found);
  widen_by_rate(recording.sample_rate_relative_std, found);
  return found;
}

}  // namespace

DecayTest run_decay_test(const signal::Recording& recording, const DecayTestOptions& options) {
  DecayTest test;
  if (auto refused = not_uniform(recording)) {
    test.findings.push_back(std::move(*refused));
    return test;
  }
  const Index from = options.start_s ? sample_at(recording, *options.start_s, true) : 0;
  const Index to =
      options.end_s ? sample_at(recording, *options.end_s, false) : recording.samples();
  if (from >= to || std::isnan(options.start_s.value_or(0)) ||
      std::isnan(options.end_s.value_or(0))) {
    throw std::invalid_argument(
        fmt::format("nothing between start and end: the record lasts from {} s to {} s",
                    recording.start_time_s, recording.start_time_s + recording.duration_s()));
  }
  auto names = options.channels;
  if (names.empty())
    std::ranges::transform(recording.channels, std::back_inserter(names), &signal::Channel::name);
  for (const auto& name : names) {
    try {
      test.channels.push_back(
          channel_decays(recording, recording.channel(name), options, from, to));
    } catch (const signal::RecordingError& error) {
      test.findings.push_back({"channel", error.what(), name, true});
    }
  }
  return test;
}

}  // namespace rigfit::ident
