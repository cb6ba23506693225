#include "ident/campaign/single_tests/decay_campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "ident/campaign/single_tests/rate_uncertainty.h"
#include "signal/estimation/groups.h"

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

struct Pooled {
  signal::Estimate mean;
  signal::Interval interval;
  double scatter = 0;
};

Pooled pooled(const std::vector<double>& values, const std::vector<double>& variances) {
  const signal::GroupMean effects = signal::mean_over_groups(values, variances);
  const double std = std::sqrt(effects.variance);
  const double factor = signal::coverage_factor(0.95, effects.degrees);
  return {{effects.mean, std},
          {effects.mean - factor * std, effects.mean + factor * std},
          std::sqrt(effects.between_variance)};
}

std::vector<PooledMode> pool(const ChannelDecays& channel) {
  std::vector<PooledMode> all;
  for (const auto& mode : channel.strongest.modes) {
    std::vector<double> frequencies, frequency_variances, dampings, damping_variances;
    for (const auto& decay : channel.decays) {
      const auto* same = decay.fitted ? same_mode(mode, *decay.result) : nullptr;
      if (!same || !(same->frequency_hz.std > 0) || !(same->damping_ratio.std > 0)) continue;
      frequencies.push_back(same->frequency_hz.value);
      frequency_variances.push_back(same->frequency_hz.std * same->frequency_hz.std);
      dampings.push_back(same->damping_ratio.value);
      damping_variances.push_back(same->damping_ratio.std * same->damping_ratio.std);
    }
    if (frequencies.empty()) continue;
    const Pooled f = pooled(frequencies, frequency_variances),
                 zeta = pooled(dampings, damping_variances);
    PooledMode one{f.mean,    zeta.mean,    f.interval,        zeta.interval,
                   f.scatter, zeta.scatter, frequencies.size()};
    one.damping_ratio_interval_95.low = std::max(0.0, one.damping_ratio_interval_95.low);
    all.push_back(one);
  }
  return all;
}

void widen(signal::DecayResult& decay, double relative_std) {
  for (auto& mode : decay.modes) {
    add_rate_uncertainty(relative_std, mode.frequency_hz, &mode.frequency_interval_95_hz);
    add_rate_uncertainty(relative_std, mode.damped_frequency_hz);
  }
}

/// The uncertainty of the rate, common to all frequencies of a recording.
void widen_by_rate(double relative_std, ChannelDecays& found) {
  const double own = found.strongest.modes.empty() ? std::numeric_limits<double>::infinity()
                                                   : found.strongest.modes.front().frequency_hz.std;
  widen(found.strongest, relative_std);
  for (auto& decay : found.decays) {
    if (decay.result) widen(*decay.result, relative_std);
  }
  for (auto& mode : found.pooled) {
    add_rate_uncertainty(relative_std, mode.frequency_hz, &mode.frequency_interval_95_hz);
  }
  if (found.strongest.modes.empty()) return;
  const double first = found.strongest.modes.front().frequency_hz.value;
  if (auto said = rate_finding(relative_std, first, own, found.channel)) {
    found.findings.push_back(std::move(*said));
  }
}

class ChannelAnalysis {
 public:
  ChannelAnalysis(const signal::Recording& recording, const signal::Channel& channel,
                  const DecayTestOptions& options, Index from, Index to)
      : options_(options) {
    result_.channel = channel.name, result_.unit = channel.unit;
    result_.sample_rate_hz = recording.sample_rate_hz;
    result_.start_time_s =
        recording.start_time_s + static_cast<double>(from) / recording.sample_rate_hz;
    result_.samples = channel.samples.segment(from, to - from);
  }

  ChannelDecays run() {
    signal::DecayOptions decay = options_.decay;
    decay.start_time_s = result_.start_time_s;
    if (options_.start_s) decay.choose_window = decay.trim_start = false;
    auto& strongest = result_.strongest;
    strongest = signal::estimate_decay(result_.samples, result_.sample_rate_hz, decay);
    result_.start_s = time(strongest.start), result_.end_s = time(strongest.end - 1);
    add_findings(strongest, result_.channel);
    for (std::size_t k = 0; k < strongest.decays.size(); ++k) {
      const auto& window = strongest.decays[k];
      FoundDecay found{time(window.start), time(window.end - 1), false, {}, window.start};
      if (k == strongest.fitted_decay) {
        found.fitted = strongest.refusal_code.empty();
        found.start_s = result_.start_s, found.end_s = result_.end_s;
        if (options_.each) found.result = strongest, found.first = 0;
      } else if (options_.each) {
        fit(found, window, decay);
      }
      result_.decays.push_back(std::move(found));
    }
    if (options_.each) result_.pooled = pool(result_);
    return std::move(result_);
  }

 private:
  [[nodiscard]] double time(Index sample) const {
    return result_.start_time_s + static_cast<double>(sample) / result_.sample_rate_hz;
  }

  void fit(FoundDecay& found, const signal::DecayWindow& window, signal::DecayOptions decay) {
    decay.choose_window = false;
    decay.start_time_s = found.start_s;
    found.result =
        signal::estimate_decay(result_.samples.segment(window.start, window.end - window.start),
                               result_.sample_rate_hz, decay);
    const std::string where = fmt::format("{} at {:.6g} s", result_.channel, found.start_s);
    found.fitted = found.result->refusal_code.empty();
    if (found.fitted) {
      found.start_s = time(window.start + found.result->start);
      found.end_s = time(window.start + found.result->end - 1);
    } else {
      result_.findings.push_back({found.result->refusal_code,
                                  "this decay is left out: " + found.result->refusal, where,
                                  false});
    }
    add_findings(*found.result, where, false);
  }

  void add_findings(const signal::DecayResult& decay, const std::string& where,
                    bool refusal = true) {
    for (const auto& note : decay.notes) {
      result_.findings.push_back({note.code, note.message, where, false});
    }
    if (refusal && !decay.refusal_code.empty()) {
      result_.findings.push_back({decay.refusal_code, decay.refusal, where, true});
    }
  }

  const DecayTestOptions& options_;
  ChannelDecays result_;
};

}  // namespace

std::optional<Finding> not_uniform(const signal::Recording& recording) {
  if (recording.time_s.size() == 0 && recording.sample_rate_hz > 0) return std::nullopt;
  return Finding{"not_uniform",
                 recording.time_s.size() > 0
                     ? "Resample the recording first: its samples are not evenly spaced in time"
                     : "State the sample rate (sample_rate_hz, --sample-rate): the file gives none",
                 "", true};
}

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
  std::vector<const signal::Channel*> channels;
  for (const auto& name : options.channels) channels.push_back(&recording.channel(name));
  if (options.channels.empty()) {
    for (const auto& channel : recording.channels) channels.push_back(&channel);
  }
  for (const auto* channel : channels) {
    test.channels.push_back(ChannelAnalysis(recording, *channel, options, from, to).run());
    if (recording.sample_rate_relative_std > 0) {
      widen_by_rate(recording.sample_rate_relative_std, test.channels.back());
    }
  }
  return test;
}

}  // namespace rigfit::ident
