#include "signal/quality/quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "signal/estimation/robust.h"
#include "signal/numerics/numbers.h"
#include "signal/recording/clipping.h"
#include "signal/spectra/fft.h"

namespace rigfit::signal {
namespace {

// Samples of the same value in a row that can make a dropout, and the number of runs as long that
// chance explains, given how often neighbours are equal around them, below which they do.
constexpr Eigen::Index kDropoutRun = 8;
constexpr double kDropoutChance = 1e-3;
// Amplitude of a line over the median of its neighbourhood above which it can be mains hum; in
// white noise P(> r) = 2^(-r^2): once in 3e7 lines for 5. Hum is steady: its largest amplitude in a
// quarter of the record is not twice its smallest, as that of a decay near 50 Hz is.
constexpr double kHumRatio = 5, kHumSteadiness = 2;
// Quanta in a standard deviation below which quantisation is coarse: its rounding noise, q /
// sqrt(12), is then more than 3 % of the signal.
constexpr double kStepsPerRms = 10;

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

double median_of(const Eigen::VectorXd& values) { return median({values.begin(), values.end()}); }

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
  std::ranges::copy_if(samples.segment((samples.size() - n) / 2, n), std::back_inserter(values),
                       [](double x) { return std::isfinite(x); });
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

/// Runs of the same value that chance does not explain, those at `low` and `high` left to clipping.
std::vector<Run> improbable_runs(const Eigen::VectorXd& x) {
  std::vector<Run> runs;
  const Eigen::Index n = x.size();
  for (Eigen::Index k = 0; k < n;) {
    Eigen::Index end = k + 1;
    while (end < n && x[end] == x[k]) ++end;
    const Eigen::Index length = end - k;
    if (length >= kDropoutRun) {
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
      if (expected < kDropoutChance && pairs > 2 * static_cast<long>(kDropoutRun)) {
        runs.push_back({k, length});
      }
    }
    k = end;
  }
  return runs;
}

Eigen::VectorXd hann(Eigen::Index n) {
  return (0.5 - 0.5 * (Eigen::ArrayXd::LinSpaced(n, 0, static_cast<double>(n - 1)) * kTwoPi /
                       static_cast<double>(n))
                          .cos())
      .matrix();
}

/// Power density of Hann-windowed pieces, averaged; unit^2 / Hz.
Eigen::VectorXd power_density(const Eigen::Ref<const Eigen::VectorXd>& samples, Eigen::Index length,
                              double rate, int most, int& averages) {
  const Eigen::VectorXd window = hann(length);
  RealFft fft(length);
  Eigen::VectorXd density = Eigen::VectorXd::Zero(fft.lines());
  const Eigen::Index room = samples.size() - length;
  averages = static_cast<int>(std::min<Eigen::Index>(most, 1 + 2 * room / length));
  for (int k = 0; k < averages; ++k) {
    const Eigen::Index at = averages == 1 ? 0 : room * k / (averages - 1);
    const auto piece = samples.segment(at, length);
    fft.time() = ((piece.array() - piece.mean()) * window.array()).matrix();
    fft.forward();
    density += fft.spectrum().cwiseAbs2();
  }
  return density * (2 / (rate * window.squaredNorm() * averages));
}

/// Rms of a line near `frequency` that stands out of the spectrum of every quarter, as narrow as
/// the window, and is steady; 0: there is none.
double steady_line(const std::vector<Eigen::VectorXd>& quarters, double frequency, double spacing) {
  double power = 0, least = std::numeric_limits<double>::infinity(), most = 0;
  for (const auto& density : quarters) {
    // European and American grids keep within 0.2 Hz.
    const double reach = 0.004 * frequency / spacing + 1;
    const auto low = static_cast<Eigen::Index>(std::floor(frequency / spacing - reach));
    const auto high = static_cast<Eigen::Index>(std::ceil(frequency / spacing + reach));
    if (low < 8 || high + 8 >= density.size()) return 0;
    Eigen::Index peak = 0;
    density.segment(low, high - low + 1).maxCoeff(&peak);
    peak += low;
    // Some 40 lines on either side, without the window's main lobe; from the fourth line on a
    // steady sinusoid has below 1e-3 of its power.
    std::vector<double> around;
    for (Eigen::Index k = std::max<Eigen::Index>(1, peak - 44);
         k <= std::min(density.size() - 1, peak + 44); ++k) {
      const Eigen::Index beside = std::abs(k - peak);
      if (beside > 3) around.push_back(density[k]);
      if (beside > 3 && beside < 7 && density[k] > 0.02 * density[peak]) return 0;
    }
    if (!(density[peak] > kHumRatio * kHumRatio * median(std::move(around)))) return 0;
    const double own = density.segment(peak - 3, 7).sum() * spacing;
    power += own / static_cast<double>(quarters.size());
    least = std::min(least, own);
    most = std::max(most, own);
  }
  return most > kHumSteadiness * kHumSteadiness * least ? 0 : std::sqrt(power);
}

/// Noise floor and hum of `samples` without NaN; returns the number of hum's lines, the fundamental
/// included. Hann windows; the median density of averaged periodograms, corrected for the bias of a
/// median (Wilson and Hilferty).
int measure_spectrum(const Eigen::Ref<const Eigen::VectorXd>& samples, double sample_rate_hz,
                     ChannelQuality& q) {
  const Eigen::Index n = samples.size();
  int lines = 0, averages = 1;
  if (n < 64 || !(sample_rate_hz > 0)) return lines;
  constexpr Eigen::Index kPiece = 8192;
  const Eigen::VectorXd density = power_density(samples, good_fft_length_below(std::min(n, kPiece)),
                                                sample_rate_hz, 64, averages);
  // Pieces overlap by half: with a Hann window about 0.95 of them count as independent.
  const double independent = 1 + 0.95 * (averages - 1);
  const double bias = std::pow(1 - 1 / (9 * independent), 3);
  q.noise_floor =
      std::sqrt(median_of(density.tail(density.size() - 1)) / bias * sample_rate_hz / 2);

  // Hum: quarters of up to a million samples from the middle; one second separates 50 from 51 Hz.
  constexpr Eigen::Index kLong = Eigen::Index{1} << 20;
  const Eigen::Index length =
      good_fft_length_below(std::max<Eigen::Index>(8, std::min(n, kLong)) / 4);
  if (static_cast<double>(length) < sample_rate_hz) return lines;
  std::vector<Eigen::VectorXd> quarters;
  for (int k = 0; k < 4; ++k) {
    quarters.push_back(power_density(samples.segment((n - 4 * length) / 2 + k * length, length),
                                     length, sample_rate_hz, 1, averages));
  }
  const double spacing = sample_rate_hz / static_cast<double>(length);
  for (const double mains : {50.0, 60.0}) {
    double power = 0;
    int found = 0;
    for (int harmonic = 1; harmonic <= 6; ++harmonic) {
      const double rms = steady_line(quarters, mains * harmonic, spacing);
      if (harmonic == 1 && rms == 0) break;
      found += rms > 0 ? 1 : 0;
      power += rms * rms;
    }
    if (power <= q.mains_rms * q.mains_rms) continue;
    q.mains_hz = mains;
    q.mains_rms = std::sqrt(power);
    lines = found;
  }
  return lines;
}

bool rests_at_zero(Quantity quantity) {
  using enum Quantity;  // loads, positions and temperatures have a mean of their own
  return quantity == acceleration || quantity == velocity || quantity == angular_velocity ||
         quantity == angular_acceleration || quantity == voltage || quantity == unknown;
}

ChannelQuality check_channel(const Recording& recording, const Channel& channel) {
  ChannelQuality q;
  q.channel = channel.name;
  const Eigen::VectorXd& x = channel.samples;
  const Eigen::Index n = x.size();
  const auto is_finite = [](double value) { return std::isfinite(value); };
  std::vector<double> there;
  std::ranges::copy_if(x, std::back_inserter(there), is_finite);
  const auto first_missing = std::ranges::find_if_not(x, is_finite) - x.begin();
  const auto count = static_cast<Eigen::Index>(there.size());
  q.missing_samples = n - count;
  const auto add = [&]<typename... Values>(const char* code, long samples, Eigen::Index first,
                                           fmt::format_string<Values...> message,
                                           Values&&... values) {
    q.findings.push_back(
        {code, fmt::format(message, std::forward<Values>(values)...), samples, first});
  };
  if (q.missing_samples > 0) {
    add("missing", q.missing_samples, first_missing, "{} of {} samples missing, first at {}",
        q.missing_samples, n, at_time(first_missing, recording));
  }
  if (count == 0) {
    q.min = q.max = q.mean = q.rms = kNaN;
    return q;
  }
  const Eigen::Map<const Eigen::ArrayXd> finite(there.data(), count);
  const double low = finite.minCoeff(), high = finite.maxCoeff();
  q.min = low, q.max = high;
  q.mean = finite.mean();
  q.rms = std::sqrt(finite.square().mean());
  const double std = std::sqrt((finite - q.mean).square().mean());
  const double range = high - low;
  if (!(range > 0)) {
    if (count > 1) {
      q.stuck_samples = count;
      add("stuck", count, 0, "all samples have the same value, {}", with_unit(low, channel));
    }
    return q;
  }

  long distinct = 0;
  q.quantum = quantum_of(x, range, distinct);
  const Eigen::VectorXd filled = without_gaps(x);
  if (count >= 16 && distinct <= 2) {
    add("one_bit", 0, -1, "only {} different values", distinct);
  } else if (count >= 16 && q.quantum > 0 && std < kStepsPerRms * q.quantum) {
    add("coarse_quantisation", 0, -1, "steps of {} are coarse for a standard deviation of {}",
        with_unit(q.quantum, channel), with_unit(std, channel));
  }

  if (distinct > 2) {
    const ClippedSamples clipped = clipped_samples(x, channel.nominal_range);
    q.clipped_samples = clipped.count;
    std::string level;
    for (const double rail : clipped.levels) {
      level += (level.empty() ? "" : " and ") + with_unit(rail, channel);
    }
    const double rail = std::max(std::abs(low), std::abs(high));
    if (clipped.levels.empty()) level = "the range of " + with_unit(channel.nominal_range, channel);
    if (!clipped.levels.empty() && rail < 0.999 * channel.nominal_range) {
      level += fmt::format(" (below the range of {})", with_unit(channel.nominal_range, channel));
    }
    if (clipped.count > 0) {
      add("clipped", clipped.count, clipped.first, "{} samples clipped at {}, first at {}",
          clipped.count, level, at_time(clipped.first, recording));
    }
  }

  if (distinct > 2) {
    long dropped = 0, dropouts = 0;
    Eigen::Index longest = 0, first = -1;
    for (const Run& run : improbable_runs(x)) {
      const double value = x[run.first];
      const bool at_extreme = value == high || value == low;
      if (at_extreme && q.clipped_samples > 0) continue;
      q.stuck_samples += run.length;
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

  // Slow things.
  const Eigen::Index tenth = n / 10;
  if (tenth >= 4) {
    const double begin = median_of(filled.head(tenth)), end = median_of(filled.tail(tenth));
    q.drift = end - begin;
    const Eigen::ArrayXd rest =
        filled.array() - q.drift / (0.9 * static_cast<double>(n)) *
                             Eigen::ArrayXd::LinSpaced(n, 0, static_cast<double>(n - 1));
    const double left = std::sqrt((rest - rest.mean()).square().mean());
    if (std::abs(q.drift) > left && std::abs(q.drift) > 2 * q.quantum) {
      add("drift", 0, -1, "drifts by {} over the record, {}", with_unit(q.drift, channel),
          std::abs(q.drift) < 1000 * left
              ? fmt::format("{:.2g} times what is left of its standard deviation",
                            std::abs(q.drift) / left)
              : std::string("and does hardly anything else: a ramp"));
    }
  }
  if (count >= 16 && rests_at_zero(channel.quantity) && std > 0 && std::abs(q.mean) > std) {
    add("offset", 0, -1, "mean {} is {:.2g} times the standard deviation",
        with_unit(q.mean, channel), std::abs(q.mean) / std);
  }

  if (recording.sample_rate_hz > 0 && recording.time_s.size() == 0) {
    const int lines = measure_spectrum(filled, recording.sample_rate_hz, q);
    if (q.mains_hz > 0) {
      add("mains_hum", 0, -1,
          "may be mains hum: steady lines at {:.0f} Hz and {} harmonics, {} rms", q.mains_hz,
          lines - 1, with_unit(q.mains_rms, channel));
    }
    if (std > 0 && q.noise_floor > 0.5 * std && count >= 256) {
      add("noise_floor", 0, -1, "the broadband floor ({} rms) is {:.0f} % of the signal",
          with_unit(q.noise_floor, channel), 100 * std::min(1.0, q.noise_floor / std));
    }
  }
  return q;
}

}  // namespace

QualityResult check_quality(const Recording& recording) {
  QualityResult result;
  result.channels.reserve(recording.channels.size());
  for (const auto& channel : recording.channels) {
    result.channels.push_back(check_channel(recording, channel));
  }
  return result;
}

}  // namespace rigfit::signal
