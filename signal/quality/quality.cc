#include "signal/quality/quality.h"

#include <fmt/format.h>

#include "signal/estimation/robust.h"
#include "signal/recording/clipping.h"

namespace rigfit::signal {
namespace {

// Samples of the same value in a row that can make a dropout, and how many times longer than the
// others around it it then is: of runs by chance, each as likely to go on, the longest of a
// thousand samples is five times as long once in 1e12 records.
constexpr Index kDropoutRun = 8, kDropoutRatio = 5;
// Quanta in a standard deviation below which quantisation is coarse: its rounding noise, q /
// sqrt(12), is then more than 3 % of the signal.
constexpr double kStepsPerRms = 10;

struct Run {
  Index first = 0, length = 0;
};

/// Values with their unit, for messages.
std::string with_unit(double value, const Channel& channel) {
  return fmt::format("{:.4g}{}{}", value, channel.unit.empty() ? "" : " ", channel.unit);
}

std::string at_time(Index sample, const Recording& recording) {
  if (!(recording.sample_rate_hz > 0)) return fmt::format("sample {}", sample + 1);
  return fmt::format("{:.6g} s", recording.time_at(sample));
}

/// Smallest step between the values there are, and how many there are. Steps below 1e-7 of the
/// range come from printing and rounding, not from a converter.
double quantum_of(const std::vector<double>& samples, double range, long& distinct) {
  constexpr std::ptrdiff_t kLooked = 1 << 16;
  const std::ptrdiff_t n = std::min(std::ssize(samples), kLooked);
  const auto middle = samples.begin() + (std::ssize(samples) - n) / 2;
  std::vector<double> values(middle, middle + n);
  std::ranges::sort(values);
  distinct = 1;
  double quantum = 0;
  for (std::size_t k = 1; k < values.size(); ++k) {
    const double step = values[k] - values[k - 1];
    if (step <= 1e-7 * range) continue;
    ++distinct;
    if (quantum == 0 || step < quantum) quantum = step;
  }
  return quantum;
}

/// Runs of the same value that are much longer than the others around them.
std::vector<Run> improbable_runs(const VectorXd& x) {
  std::vector<Run> runs, found;
  for (Index k = 0, end = 1; k < x.size(); k = end++) {
    while (end < x.size() && x[end] == x[k]) ++end;
    if (end - k > 1) runs.push_back({k, end - k});
  }
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const auto [first, length] = runs[k];
    if (length < kDropoutRun) continue;
    const Index reach = std::max<Index>(100, 10 * length);
    Index longest = 1;
    for (std::size_t j = k; j-- > 0 && runs[j].first + runs[j].length > first - reach;) {
      longest = std::max(longest, runs[j].length);
    }
    for (std::size_t j = k + 1; j < runs.size() && runs[j].first < first + length + reach; ++j) {
      longest = std::max(longest, runs[j].length);
    }
    if (length > kDropoutRatio * longest) found.push_back(runs[k]);
  }
  return found;
}

ChannelQuality check_channel(const Recording& recording, const Channel& channel) {
  ChannelQuality q;
  q.channel = &channel;
  const VectorXd& x = channel.samples;
  const Index n = x.size();
  const std::vector<double> there = finite_values(x);
  const auto count = static_cast<Index>(there.size());
  q.missing_samples = n - count;
  const auto add = [&]<typename... Values>(const char* code, long samples, Index first,
                                           fmt::format_string<Values...> message,
                                           Values&&... values) {
    q.findings.push_back(
        {code, fmt::format(message, std::forward<Values>(values)...), samples, first});
  };
  if (q.missing_samples > 0) {
    const auto first =
        std::ranges::find_if_not(x, [](double v) { return std::isfinite(v); }) - x.begin();
    add("missing", q.missing_samples, first, "{} of {} samples missing, first at {}",
        q.missing_samples, n, at_time(first, recording));
  }
  if (count == 0) {
    q.min = q.max = q.mean = q.rms = kNaN;
    return q;
  }
  const Map<const ArrayXd> finite(there.data(), count);
  q.min = finite.minCoeff(), q.max = finite.maxCoeff(), q.mean = finite.mean();
  q.rms = std::sqrt(finite.square().mean());
  const double std = std::sqrt((finite - q.mean).square().mean());
  if (!(q.max > q.min)) {
    if (count > 1) {
      add("stuck", count, 0, "all samples have the same value, {}", with_unit(q.min, channel));
    }
    return q;
  }

  long distinct = 0;
  const double quantum = quantum_of(there, q.max - q.min, distinct);
  if (count >= 16 && distinct <= 2) {
    add("one_bit", 0, -1, "only {} different values", distinct);
  } else if (count >= 16 && quantum > 0 && std < kStepsPerRms * quantum) {
    add("coarse_quantisation", 0, -1, "steps of {} are coarse for a standard deviation of {}",
        with_unit(quantum, channel), with_unit(std, channel));
  }

  if (distinct > 2) {
    const ClippedSamples clipped = clipped_samples(x, channel.nominal_range);
    q.clipped_samples = clipped.count;
    std::string level;
    for (const double rail : clipped.levels) {
      level += (level.empty() ? "" : " and ") + with_unit(rail, channel);
    }
    const std::string range = "the range of " + with_unit(channel.nominal_range, channel);
    if (level.empty()) level = range;
    if (std::max(std::abs(q.min), std::abs(q.max)) < 0.999 * channel.nominal_range) {
      level += " (below " + range + ")";
    }
    if (clipped.count > 0) {
      add("clipped", clipped.count, clipped.first, "{} samples clipped at {}, first at {}",
          clipped.count, level, at_time(clipped.first, recording));
    }

    long dropped = 0, dropouts = 0;
    Index longest = 0, first = -1;
    for (const Run& run : improbable_runs(x)) {
      const double value = x[run.first];
      if ((value == q.max || value == q.min) && q.clipped_samples > 0) continue;
      if (run.first + run.length == n || run.first == 0) {
        add("stuck", run.length, run.first, "the same value, {}, for {} samples {}",
            with_unit(value, channel), run.length,
            run.first == 0 ? "from the beginning"
                           : "to the end from " + at_time(run.first, recording));
        continue;
      }
      if (dropouts++ == 0) first = run.first;
      dropped += run.length;
      longest = std::max(longest, run.length);
    }
    if (dropouts > 0) {
      add("dropouts", dropped, first, "{} dropouts ({} samples; the longest {}), first at {}",
          dropouts, dropped, longest, at_time(first, recording));
    }
  }
  return q;
}

}  // namespace

std::vector<ChannelQuality> check_quality(const Recording& recording) {
  std::vector<ChannelQuality> channels;
  for (const auto& one : recording.channels) channels.push_back(check_channel(recording, one));
  return channels;
}

}  // namespace rigfit::signal
