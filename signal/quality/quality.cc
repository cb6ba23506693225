#include "signal/quality/quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "signal/numerics/numbers.h"
#include "signal/quality/quality_spectrum.h"

namespace rigfit::signal {
namespace {

struct Run {
  Eigen::Index first = 0, length = 0;
};

/// Values with their unit, for messages.
std::string with_unit(double value, const Channel& channel) {
  return fmt::format("{:.4g}{}{}", value, channel.unit.empty() ? "" : " ", channel.unit);
}

std::string at_time(Eigen::Index sample, const Recording& recording) {
  if (!(recording.sample_rate_hz > 0)) return fmt::format("sample {}", sample + 1);
  const double time =
      recording.time_s.size() > sample
          ? recording.time_s[sample]
          : recording.start_time_s + static_cast<double>(sample) / recording.sample_rate_hz;
  return fmt::format("{:.6g} s", time);
}

double median_of(Eigen::VectorXd values) {
  const auto middle = values.data() + values.size() / 2;
  std::nth_element(values.data(), middle, values.data() + values.size());
  return *middle;
}

/// Missing samples replaced by the line between their neighbours, for the spectrum only.
Eigen::VectorXd without_gaps(const Eigen::VectorXd& samples) {
  Eigen::VectorXd out = samples;
  Eigen::Index last = -1;
  for (Eigen::Index k = 0; k < out.size(); ++k) {
    if (!std::isfinite(out[k])) continue;
    for (Eigen::Index j = last + 1; j < k; ++j) {
      const double share = static_cast<double>(j - last) / static_cast<double>(k - last);
      out[j] = last < 0 ? out[k] : out[last] + share * (out[k] - out[last]);
    }
    last = k;
  }
  for (Eigen::Index j = last + 1; j < out.size(); ++j) out[j] = last < 0 ? 0 : out[last];
  return out;
}

/// Smallest step between the values there are, and how many there are (at most `most` counted).
/// Steps below 1e-7 of the range come from printing and rounding, not from a converter.
double quantum_of(const Eigen::VectorXd& samples, double range, long& distinct) {
  constexpr Eigen::Index kLooked = 1 << 16;
  const Eigen::Index n = std::min(samples.size(), kLooked);
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(n));
  const Eigen::Index from = (samples.size() - n) / 2;
  for (Eigen::Index k = from; k < from + n; ++k) {
    if (std::isfinite(samples[k])) values.push_back(samples[k]);
  }
  std::sort(values.begin(), values.end());
  distinct = values.empty() ? 0 : 1;
  double quantum = 0;
  for (std::size_t k = 1; k < values.size(); ++k) {
    const double step = values[k] - values[k - 1];
    if (step <= 1e-7 * range) continue;
    ++distinct;
    if (quantum == 0 || step < quantum) quantum = step;
  }
  return quantum;
}

/// Flat tops at one extreme: samples at it, when at least one of them is no smooth peak.
struct Tops {
  long tops = 0, samples = 0;
  Eigen::Index first = -1;
};

Tops flat_tops(const Eigen::VectorXd& x, double level, double range, double quantum,
               const QualityOptions& options) {
  Tops result;
  long at_level = 0;
  const double equal = 1e-9 * range;
  for (Eigen::Index k = 0; k < x.size();) {
    if (!(std::abs(x[k] - level) <= equal)) {
      ++k;
      continue;
    }
    Eigen::Index end = k + 1;
    while (end < x.size() && std::abs(x[end] - level) <= equal) ++end;
    at_level += end - k;
    if (end - k >= options.clip_run) {
      const double in = k > 0 ? std::abs(x[k - 1] - level) : 0;
      const double out = end < x.size() ? std::abs(x[end] - level) : 0;
      const double step = std::max(std::isfinite(in) ? in : 0, std::isfinite(out) ? out : 0);
      if (step >= options.clip_step_quanta * quantum && step > 0) {
        if (result.tops++ == 0) result.first = k;
      }
    }
    k = end;
  }
  if (result.tops > 0) result.samples = at_level;
  return result;
}

/// Runs of the same value that chance does not explain, those at `low` and `high` left to clipping.
std::vector<Run> improbable_runs(const Eigen::VectorXd& x, const QualityOptions& options) {
  std::vector<Run> runs;
  const Eigen::Index n = x.size();
  for (Eigen::Index k = 0; k < n;) {
    Eigen::Index end = k + 1;
    while (end < n && x[end] == x[k]) ++end;
    const Eigen::Index length = end - k;
    if (length >= options.dropout_run) {
      const Eigen::Index reach = std::max<Eigen::Index>(100, 10 * length);
      long pairs = 0, equal = 0, from_value = 0, stays = 0;
      const auto count = [&](Eigen::Index from, Eigen::Index to) {
        for (Eigen::Index j = std::max<Eigen::Index>(from, 0) + 1; j < std::min(to, n); ++j) {
          if (!std::isfinite(x[j]) || !std::isfinite(x[j - 1])) continue;
          ++pairs;
          equal += x[j] == x[j - 1] ? 1 : 0;
          if (x[j - 1] != x[k]) continue;
          ++from_value;
          stays += x[j] == x[k] ? 1 : 0;
        }
      };
      count(k - reach, k);
      count(end, end + reach);
      // One more equal pair than seen: a rate of zero would make everything improbable. A value at
      // which the signal often rests is kept longer than the others.
      double chance = (static_cast<double>(equal) + 1) / (static_cast<double>(pairs) + 2);
      if (from_value >= 20) {
        chance = std::max(chance,
                          (static_cast<double>(stays) + 1) / (static_cast<double>(from_value) + 2));
      }
      const double expected =
          static_cast<double>(n) * std::pow(chance, static_cast<double>(length - 1));
      if (expected < options.dropout_chance && pairs > 2 * options.dropout_run) {
        runs.push_back({k, length});
      }
    }
    k = end;
  }
  return runs;
}

bool rests_at_zero(Quantity quantity) {
  switch (quantity) {
    case Quantity::acceleration:
    case Quantity::velocity:
    case Quantity::angular_velocity:
    case Quantity::angular_acceleration:
    case Quantity::voltage:
    case Quantity::unknown:
      return true;
    default:
      return false;  // loads, positions and temperatures have a mean of their own
  }
}

ChannelQuality check_channel(const Recording& recording, const Channel& channel,
                             const QualityOptions& options) {
  ChannelQuality q;
  q.channel = channel.name;
  const Eigen::VectorXd& x = channel.samples;
  const Eigen::Index n = x.size();
  double sum = 0, squares = 0, low = 0, high = 0;
  Eigen::Index count = 0, first_missing = -1;
  for (Eigen::Index k = 0; k < n; ++k) {
    if (!std::isfinite(x[k])) {
      if (first_missing < 0) first_missing = k;
      continue;
    }
    low = count == 0 ? x[k] : std::min(low, x[k]);
    high = count == 0 ? x[k] : std::max(high, x[k]);
    sum += x[k];
    squares += x[k] * x[k];
    ++count;
  }
  q.missing_samples = n - count;
  const auto add = [&](const char* code, std::string message, long samples, Eigen::Index first) {
    q.findings.push_back({code, std::move(message), samples, first});
  };
  if (q.missing_samples > 0) {
    add("missing",
        fmt::format("{} of {} samples missing, first at {}", q.missing_samples, n,
                    at_time(first_missing, recording)),
        q.missing_samples, first_missing);
  }
  if (count == 0) {
    q.min = q.max = q.mean = q.rms = kNaN;
    return q;
  }
  q.min = low, q.max = high;
  q.mean = sum / static_cast<double>(count);
  q.rms = std::sqrt(squares / static_cast<double>(count));
  double spread = 0;
  for (const double v : x) {
    if (std::isfinite(v)) spread += (v - q.mean) * (v - q.mean);
  }
  const double std = std::sqrt(spread / static_cast<double>(count));
  const double range = high - low;
  if (!(range > 0)) {
    if (count > 1) {
      q.stuck_samples = count;
      add("stuck", "all samples have the same value, " + with_unit(low, channel), count, 0);
    }
    return q;
  }

  long distinct = 0;
  q.quantum = quantum_of(x, range, distinct);
  const Eigen::VectorXd filled = without_gaps(x);
  const double rest = median_of(filled);
  if (count >= 16 && distinct <= 2) {
    add("one_bit", fmt::format("only {} different values", distinct), 0, -1);
  } else if (count >= 16 && q.quantum > 0 && std < options.steps_per_rms * q.quantum) {
    add("coarse_quantisation",
        fmt::format("steps of {} are coarse for a standard deviation of {}",
                    with_unit(q.quantum, channel), with_unit(std, channel)),
        0, -1);
  }

  // Clipping: at the stated range, or flat tops at an extreme that is not where the signal rests.
  Eigen::Index first_clipped = -1;
  long tops = 0;
  std::string level;
  if (distinct > 2) {
    for (const double extreme : {high, low}) {
      if (std::abs(extreme - rest) <= 1e-9 * range) continue;
      const Tops found = flat_tops(x, extreme, range, q.quantum, options);
      if (found.tops == 0) continue;
      q.clipped_samples += found.samples;
      tops += found.tops;
      if (first_clipped < 0 || found.first < first_clipped) first_clipped = found.first;
      level += (level.empty() ? "" : " and ") + with_unit(extreme, channel);
    }
  }
  if (channel.nominal_range > 0) {
    long beyond = 0;
    Eigen::Index first = -1;
    for (Eigen::Index k = 0; k < n; ++k) {
      if (!(std::abs(x[k]) >= options.range_share * channel.nominal_range)) continue;
      if (beyond++ == 0) first = k;
    }
    if (beyond > q.clipped_samples) {
      q.clipped_samples = beyond;
      first_clipped = first;
      level = "the range of " + with_unit(channel.nominal_range, channel);
      tops = std::max(tops, 1L);
    }
  }
  if (q.clipped_samples > 0) {
    const bool below = channel.nominal_range > 0 && std::max(std::abs(low), std::abs(high)) <
                                                        options.range_share * channel.nominal_range;
    add("clipped",
        fmt::format("{} samples clipped at {}{}, first at {}", q.clipped_samples, level,
                    below ? fmt::format(" (below the range of {})",
                                        with_unit(channel.nominal_range, channel))
                          : "",
                    at_time(first_clipped, recording)),
        q.clipped_samples, first_clipped);
  }

  if (distinct > 2) {
    long dropped = 0, dropouts = 0;
    Eigen::Index longest = 0, first = -1;
    for (const Run& run : improbable_runs(x, options)) {
      const double value = x[run.first];
      const bool at_extreme = value == high || value == low;
      if (at_extreme && q.clipped_samples > 0) continue;
      q.stuck_samples += run.length;
      if (run.first + run.length == n || run.first == 0) {
        add("stuck",
            fmt::format("the same value, {}, for {} samples {}", with_unit(value, channel),
                        run.length,
                        run.first == 0 ? "from the beginning"
                                       : "to the end from " + at_time(run.first, recording)),
            run.length, run.first);
        continue;
      }
      if (dropouts++ == 0) first = run.first;
      dropped += run.length;
      longest = std::max(longest, run.length);
    }
    if (dropouts > 0) {
      add("dropouts",
          fmt::format("{} dropouts ({} samples; the longest {}), first at {}", dropouts, dropped,
                      longest, at_time(first, recording)),
          dropped, first);
    }
  }

  // Slow things.
  const Eigen::Index tenth = n / 10;
  if (tenth >= 4) {
    const double begin = median_of(filled.head(tenth)), end = median_of(filled.tail(tenth));
    q.drift = end - begin;
    double left = 0, middle = 0;
    const auto detrended = [&](Eigen::Index k) {
      return filled[k] - q.drift * static_cast<double>(k) / (0.9 * static_cast<double>(n));
    };
    for (Eigen::Index k = 0; k < n; ++k) middle += detrended(k);
    middle /= static_cast<double>(n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const double d = detrended(k) - middle;
      left += d * d;
    }
    left = std::sqrt(left / static_cast<double>(n));
    if (std::abs(q.drift) > options.drift_ratio * left && std::abs(q.drift) > 2 * q.quantum) {
      add("drift",
          fmt::format("drifts by {} over the record, {}", with_unit(q.drift, channel),
                      std::abs(q.drift) < 1000 * left
                          ? fmt::format("{:.2g} times what is left of its standard deviation",
                                        std::abs(q.drift) / left)
                          : std::string("and does hardly anything else: a ramp")),
          0, -1);
    }
  }
  if (count >= 16 && rests_at_zero(channel.quantity) && std > 0 &&
      std::abs(q.mean) > options.offset_ratio * std) {
    add("offset",
        fmt::format("mean {} is {:.2g} times the standard deviation", with_unit(q.mean, channel),
                    std::abs(q.mean) / std),
        0, -1);
  }

  if (recording.sample_rate_hz > 0 && recording.time_s.size() == 0) {
    const SpectralQuality spectrum = spectral_quality(filled, recording.sample_rate_hz, options);
    q.noise_floor = spectrum.noise_floor;
    q.mains_hz = spectrum.mains_hz;
    q.mains_rms = spectrum.mains_rms;
    if (q.mains_hz > 0) {
      add("mains_hum",
          fmt::format("may be mains hum: steady lines at {:.0f} Hz and {} harmonics, {} rms",
                      q.mains_hz, spectrum.harmonics - 1, with_unit(q.mains_rms, channel)),
          0, -1);
    }
    if (std > 0 && q.noise_floor > 0.5 * std && count >= 256) {
      add("noise_floor",
          fmt::format("the broadband floor ({} rms) is {:.0f} % of the signal",
                      with_unit(q.noise_floor, channel), 100 * std::min(1.0, q.noise_floor / std)),
          0, -1);
    }
  }
  return q;
}

}  // namespace

QualityResult check_quality(const Recording& recording, const QualityOptions& options) {
  QualityResult result;
  result.channels.reserve(recording.channels.size());
  for (const auto& channel : recording.channels) {
    result.channels.push_back(check_channel(recording, channel, options));
  }
  return result;
}

}  // namespace rigfit::signal
