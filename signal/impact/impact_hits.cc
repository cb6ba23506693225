#include "signal/impact/impact_hits.h"

#include "signal/estimation/robust.h"
#include "signal/recording/add_note.h"
#include "signal/recording/clipping.h"
#include "signal/spectra/fft.h"
#include "signal/spectra/force_noise.h"
#include "signal/spectra/window.h"

namespace rigfit::signal {
namespace {

constexpr double kTriggerNoise = 10;  // standard deviations of the noise
constexpr double kHitWindow =
    0.25;  // s around a peak, within which pulses are no hits of their own

/// What is known about a channel as a whole.
struct ChannelFacts {
  double rest;
  ClippedSamples clipped;
  explicit ChannelFacts(const Channel& channel)
      : rest(median(finite_values(channel.samples))),
        clipped(clipped_samples(channel.samples, channel.nominal_range)) {}
};

/// Samples as the search sees them: offset removed, missing ones zero.
struct ForceTrace {
  VectorXd x;
  double offset = 0, noise = 0;

  explicit ForceTrace(const VectorXd& samples) {
    std::vector<double> values = finite_values(samples);
    offset = median(values);
    noise = robust_std(std::move(values), offset);
    x = samples.unaryExpr([this](double v) { return std::isfinite(v) ? v - offset : 0.0; });
  }
};

// Whether a channel looks like a hammer's force around a hit, or like a response.
//
// A hammer pushes to one side, shortly, and its force is zero before and after. A response swings
// to both sides and rings on. Two figures tell them apart: the largest swing to the other side over
// the peak, and the part of the energy that comes more than five pulse widths away from the pulse,
// both beyond what the channel's noise gives.

/// A pulse ends below this part of its peak.
constexpr double kPulseEdge = 0.1;

/// As it is made: neither.
struct PulseShape {
  double opposite = 0.4;  ///< largest swing to the other side, of the peak, 0..1
  double outside = 0.25;  ///< energy outside of pulse and surroundings, of all, 0..1
  /// Hammers that ring in their own handle, filters and AC-coupled amplifiers stay below 0.3 in
  /// both, a mode of 10 % damping swings back by 0.73; modes damped by more leave nothing outside
  /// and are not told.
  [[nodiscard]] bool rings() const { return opposite > 0.5 && outside > 0.3; }
  [[nodiscard]] bool is_pulse() const { return opposite < 0.3 && outside < 0.2; }
};

/// Shape of the samples first .. first + length - 1 with their largest absolute value as the peak.
/// Rest and noise are taken where the block is quietest: before the hit or at its end. Missing
/// samples count as rest. No signal: neither rings nor is a pulse.
PulseShape pulse_shape(const VectorXd& samples, Index first, Index length) {
  first = std::clamp<Index>(first, 0, samples.size());
  length = std::min(length, samples.size() - first);
  if (length < 8) return {};
  const Index quiet = std::max<Index>(4, length / 40);
  const ForceTrace begin(samples.segment(first, quiet));
  const ForceTrace end(samples.segment(first + length - quiet, quiet));
  const ForceTrace& still = begin.noise < end.noise ? begin : end;
  const double rest = still.offset, noise = still.noise;
  const VectorXd x = samples.segment(first, length).unaryExpr([&](double v) {
    return std::isfinite(v) ? v - rest : 0.0;
  });
  Index peak = 0;
  const double height = x.cwiseAbs().maxCoeff(&peak);
  if (!(height > 6 * noise)) return {};
  const double sign = x[peak] > 0 ? 1 : -1;
  Index pulse_first = peak, pulse_last = peak;
  while (pulse_first > 0 && sign * x[pulse_first - 1] > kPulseEdge * height) --pulse_first;
  while (pulse_last + 1 < length && sign * x[pulse_last + 1] > kPulseEdge * height) ++pulse_last;
  const Index width = pulse_last - pulse_first + 1;
  const Index inner_first = std::max<Index>(0, pulse_first - 5 * width);
  const Index inner_last = std::min(length, pulse_last + 5 * width + 1);
  const auto energy = [&](Index from, Index to) {
    return std::max(0.0, x.segment(from, to - from).squaredNorm() -
                             noise * noise * static_cast<double>(to - from));
  };
  PulseShape shape;
  const double inside = energy(inner_first, inner_last);
  const double outside = energy(0, inner_first) + energy(inner_last, length);
  shape.outside = inside + outside > 0 ? outside / (inside + outside) : 0;
  shape.opposite = std::max(0.0, (-sign * x).maxCoeff() - 3 * noise) / height;
  return shape;
}

// Second contacts of a hammer with the structure, before or after the hit:
// y(k) = sum_i p_i x(k + i) / sum_i p_i^2 with p the hit's own pulse scaled to one: a second
// contact of the same shape and a times the height peaks at y = a times the hit's peak, white noise
// falls by sqrt(sum p^2).

VectorXd correlate(const VectorXd& force, Index pulse_first, Index peak, Index width) {
  const Index before = peak - pulse_first;
  const VectorXd pulse = force.segment(pulse_first, width) / force[peak];
  const double scale = 1 / pulse.squaredNorm();
  VectorXd y(force.size());
  for (Index k = 0; k < y.size(); ++k) {
    const Index first = std::max<Index>(0, before - k);
    const Index last = std::min(width, force.size() - (k - before));
    y[k] = last > first ? scale * pulse.segment(first, last - first)
                                      .dot(force.segment(k - before + first, last - first))
                        : 0;
  }
  return y;
}

/// Fills a hit's largest second contact from `smallest` on, relative to the peak. `force`: its
/// block, offset removed, pulses upwards, finite.
void find_second_contact(const VectorXd& force, double smallest, double rate, Hit& hit) {
  constexpr double kNoise = 6;      // it exceeds so many standard deviations of the filtered noise
  constexpr double kRinging = 0.5;  // swings to the other side of this part of its height
  const Index peak = hit.peak_sample - hit.block_first;
  const double height = force[peak];
  if (!(height > 0)) return;
  const Index n = force.size(), width = hit.pulse_last - hit.pulse_first + 1;
  const VectorXd y = correlate(force, hit.pulse_first - hit.block_first, peak, width);

  // The hit itself: a half sine ends 3.5 % of its length beyond its 10 % crossings.
  const Index guard = width + width / 10 + 1;
  const Index hit_first = std::max<Index>(0, peak - guard),
              hit_last = std::min(n - 1, peak + guard);
  std::vector<double> rest(y.begin(), y.begin() + hit_first);
  rest.insert(rest.end(), y.begin() + hit_last + 1, y.end());
  const double level = median(rest);
  const double least = std::max(smallest * height, kNoise * robust_std(rest, level));
  hit.smallest_second_hit = least / height;

  for (Index k = 1; k + 1 < n; ++k) {
    const double rise = y[k] - level;
    if (rise < least || (k >= hit_first && k <= hit_last)) continue;
    if (y[k] <= y[k - 1] || y[k] < y[k + 1]) continue;
    Index left = k, right = k;
    while (left > 0 && y[left] - level > rise / 2) --left;
    while (right + 1 < n && y[right] - level > rise / 2) ++right;
    // Ringing dies away from the hit, so the swing between it and the hit is the larger one.
    const Index reach = 2 * (right - left + 1) + width;
    const Index from = k > peak ? std::max(peak, k - reach) : k + 1;
    const Index to = k > peak ? k : std::min(peak, k + reach) + 1;
    if (level - y.segment(from, to - from).minCoeff() >= kRinging * rise) continue;
    if (rise / height > hit.second_hit) {
      hit.second_hit = rise / height;
      hit.second_hit_delay_s = static_cast<double>(k - peak) / rate;
    }
  }
}

/// Peaks above the level, none closer to a larger one than `apart`. `sign` 0: either side.
std::vector<Index> find_peaks(const ForceTrace& trace, int sign, double trigger, Index apart) {
  const auto value = [&](Index k) { return sign == 0 ? std::abs(trace.x[k]) : sign * trace.x[k]; };
  double largest = 0;
  for (Index k = 0; k < trace.x.size(); ++k) largest = std::max(largest, value(k));
  const double level = std::max(trigger * largest, kTriggerNoise * trace.noise);
  std::vector<Index> peaks;
  if (!(largest > 0)) return peaks;
  Index last_above = -1;
  for (Index k = 0; k < trace.x.size(); ++k) {
    if (value(k) < level) continue;
    if (last_above < 0 || k - last_above > apart) {
      peaks.push_back(k);
    } else if (value(k) > value(peaks.back())) {
      peaks.back() = k;
    }
    last_above = k;
  }
  return peaks;
}

void measure_pulse(const VectorXd& force, int sign, double rate, Index earliest, Hit& hit) {
  const Index n = force.size();
  const auto value = [&](Index k) { return sign * (force[k] - hit.offset); };
  const auto edges = [&] {
    const double edge = kPulseEdge * value(hit.peak_sample);
    hit.pulse_first = hit.pulse_last = hit.peak_sample;
    while (hit.pulse_first > 0 && value(hit.pulse_first - 1) > edge) --hit.pulse_first;
    while (hit.pulse_last + 1 < n && value(hit.pulse_last + 1) > edge) ++hit.pulse_last;
    return edge;
  };
  edges();
  // The offset just before the hit, where there is enough of it: amplifiers drift.
  const Index width = hit.pulse_last - hit.pulse_first + 1;
  const Index first = std::max(earliest, hit.pulse_first - 50 * width),
              last = hit.pulse_first - width;
  if (last - first >= 16) {
    std::vector<double> before = finite_values(force.segment(first, last - first));
    if (before.size() >= 16) hit.offset = median(before);
  }
  const double edge = edges();
  // Part of a sample interval from the last sample inside to where the edge is crossed.
  const auto beyond = [&](Index last_inside, Index next) {
    if (next < 0 || next >= n) return 0.0;
    const double inside = value(last_inside), outside = value(next);
    return inside > outside ? (inside - edge) / (inside - outside) : 0.0;
  };
  const double begin =
      static_cast<double>(hit.pulse_first) - beyond(hit.pulse_first, hit.pulse_first - 1);
  const double end =
      static_cast<double>(hit.pulse_last) + beyond(hit.pulse_last, hit.pulse_last + 1);
  hit.pulse_duration_s = (end - begin) / rate;
  hit.peak = force[hit.peak_sample] - hit.offset;
}

/// Spectrum of the pulse alone, dB below its maximum.
void judge_spectrum(const VectorXd& force, double rate,
                    const std::optional<std::pair<double, double>>& band_hz, Hit& hit) {
  const Index width = hit.pulse_last - hit.pulse_first + 1;
  const Index first = std::max<Index>(0, hit.pulse_first - width);
  const Index last = std::min(force.size(), hit.pulse_last + 4 * width);
  const Index flat = hit.pulse_last + 2 * width - first;
  const VectorXd pulse =
      (force.segment(first, last - first).array() - hit.offset) *
      force_window(last - first, hit.pulse_first - first, flat, 2 * width).array();
  const Index length = good_fft_length(std::max<Index>(4096, 4 * (last - first)));
  const ArrayXd power = real_spectra(pulse, length).array().abs2();
  const ArrayXd f = line_frequencies(length, rate);
  Index top = 0;
  const double largest = power.maxCoeff(&top);
  const double least = largest * std::pow(10, -kMostSpectrumDrop / 10);
  // From the maximum on, where a dip is the end of what can be used.
  while (top + 1 < power.size() && power[top + 1] >= least) ++top;
  hit.usable_hz = f[top];
  if (!band_hz) return;
  const auto [low, high] = *band_hz;
  const double weakest = (f < low || f > high).select(largest, power).minCoeff();
  hit.spectrum_drop_db = std::min(300.0, -10 * std::log10(weakest / largest));
  if (hit.spectrum_drop_db > kMostSpectrumDrop) {
    hit.reject(HitFault::force_spectrum,
               fmt::format("the force spectrum falls by {:.1f} dB within {:g} to {:g} Hz (at most "
                           "{:g} dB; usable to {:.4g} Hz): use a harder tip or a narrower band",
                           hit.spectrum_drop_db, low, high, kMostSpectrumDrop, hit.usable_hz));
  }
}

/// A force that rings is a response; the channel that is a pulse there is named.
void judge_shape(const Recording& recording, Index force, Index block_samples, Hit& hit) {
  const Index length = std::min(block_samples, hit.available);
  const Index width = hit.pulse_last - hit.pulse_first + 1;
  // The force's pulse comes a little before a response's largest swing.
  const Index first = std::max<Index>(0, hit.block_first - 4 * width);
  const auto shape_of = [&](Index channel) {
    return pulse_shape(recording.channels[static_cast<std::size_t>(channel)].samples, first,
                       length + hit.block_first - first);
  };
  const PulseShape shape = shape_of(force);
  if (!shape.rings()) return;
  std::string hammers;
  for (Index c = 0; c < static_cast<Index>(recording.channels.size()); ++c) {
    if (c == force || !shape_of(c).is_pulse()) continue;
    hammers += fmt::format("{}\"{}\"", hammers.empty() ? "" : ", ",
                           recording.channels[static_cast<std::size_t>(c)].name);
  }
  hit.reject(
      HitFault::rings,
      fmt::format("\"{}\" swings back by {:.0f} % of its peak and has {:.0f} % of its energy "
                  "outside of the pulse: it is no hammer's force; {}",
                  recording.channels[static_cast<std::size_t>(force)].name, 100 * shape.opposite,
                  100 * shape.outside,
                  hammers.empty() ? "name the channel of the hammer as the force"
                                  : hammers + " has a short pulse there: name it as the force"));
}

/// Where the largest hit shows that the channel is no force, no other is one either: they are the
/// swings of its ring-down.
void refuse_all_where_the_largest_rings(HitSearch& search) {
  const auto largest =
      std::ranges::max_element(search.hits, {}, [](const Hit& hit) { return std::abs(hit.peak); });
  if (largest == search.hits.end() || !largest->has(HitFault::rings)) return;
  for (Hit& hit : search.hits) {
    if (!hit.has(HitFault::rings))
      hit.reject(HitFault::rings, "at the largest hit " + largest->reason);
  }
}

void judge_pulse(const Recording& recording, const Channel& force, const ChannelFacts& facts,
                 const HitOptions& options, Hit& hit) {
  const double rate = recording.sample_rate_hz;
  if (facts.clipped.any(hit.pulse_first, hit.pulse_last)) {
    hit.reject(HitFault::overload,
               fmt::format("overload: \"{}\" is clipped at {:.5g}; hit softer or raise the range",
                           force.name, force.samples[hit.peak_sample]));
  }
  const Index width = hit.pulse_last - hit.pulse_first + 1;
  std::string why;
  if (hit.pulse_first == 0) {
    why = "pulse not resolved: the record begins within it; record from before the hit";
  } else if (width < options.min_pulse_samples) {
    why = fmt::format(
        "pulse not resolved: {} sample{} above {:.0f} % of the peak at {:g} Hz, {} needed; sample "
        "at {:.3g} Hz or more, or use a softer tip",
        width, width == 1 ? "" : "s", 100 * kPulseEdge, rate, options.min_pulse_samples,
        rate * (options.min_pulse_samples + 1) / static_cast<double>(width));
  }
  if (!why.empty() && options.accept_unresolved) {
    hit.faults.push_back(HitFault::unresolved_pulse);
    hit.reason = why;
  } else if (!why.empty()) {
    hit.reject(HitFault::unresolved_pulse, why);
  }
}

/// Smallest second contact that counts as force, over the peak: an error of 0.1 % of H.
constexpr double kContact = 1e-3;

void judge_double_hit(const Channel& force, Index block_samples, int sign, double rate,
                      double smallest, Hit& hit) {
  const Index length = std::min(block_samples, hit.available);
  const VectorXd block =
      sign * (force.samples.segment(hit.block_first, length).array() - hit.offset).matrix();
  find_second_contact(block, std::min(kContact, smallest), rate, hit);
  hit.smallest_second_hit = std::max(smallest, hit.smallest_second_hit);
  if (hit.second_hit >= smallest) {
    hit.reject(HitFault::double_hit,
               fmt::format("double hit: {:.3g} % of the peak {:.4g} ms {}", 100 * hit.second_hit,
                           1e3 * std::abs(hit.second_hit_delay_s),
                           hit.second_hit_delay_s > 0 ? "later" : "earlier"));
  }
}

/// Root mean square at the end of the block, and before the hit, over the largest value: the median
/// over the responses.
void measure_levels(const Recording& recording, std::span<const Index> responses,
                    const std::vector<ChannelFacts>& facts, Index block_samples, Hit& hit) {
  const Index length = std::min(block_samples, hit.available);
  const Index tail = std::clamp<Index>(length / 40, 1, length);
  const Index before = std::max<Index>(
      0, hit.pulse_first - (hit.pulse_last - hit.pulse_first) - 1 - hit.block_first);
  std::vector<double> ends, befores;
  for (std::size_t r = 0; r < responses.size(); ++r) {
    const VectorXd y = recording.channels[static_cast<std::size_t>(responses[r])]
                           .samples.segment(hit.block_first, length)
                           .array() -
                       facts[r].rest;
    const double largest = y.cwiseAbs().maxCoeff();
    if (!(largest > 0)) continue;
    ends.push_back(std::sqrt(y.tail(tail).squaredNorm() / static_cast<double>(tail)) / largest);
    if (before >= 4) {
      befores.push_back(std::sqrt(y.head(before).squaredNorm() / static_cast<double>(before)) /
                        largest);
    }
  }
  hit.end_level = median(ends);
  hit.level_before = median(befores);
}

/// Reasons that concern the block: missing samples, overload of a response.
void judge_block(const Recording& recording, Index force, std::span<const Index> responses,
                 const std::vector<ChannelFacts>& facts, Index block_samples, Hit& hit) {
  const Index length = std::min(block_samples, hit.available);
  const auto missing = [&](Index index) {
    const Channel& channel = recording.channels[static_cast<std::size_t>(index)];
    if (channel.samples.segment(hit.block_first, length).allFinite()) return;
    hit.reject(HitFault::missing_samples,
               fmt::format("samples of \"{}\" are missing within the block", channel.name));
  };
  missing(force);
  for (std::size_t r = 0; r < responses.size(); ++r) {
    missing(responses[r]);
    const Channel& response = recording.channels[static_cast<std::size_t>(responses[r])];
    if (facts[r].clipped.any(hit.block_first, hit.block_first + length - 1)) {
      hit.reject(
          HitFault::overload,
          fmt::format("overload: \"{}\" is clipped; hit softer or raise the range", response.name));
    }
  }
}

Index median_width(const std::vector<Hit>& hits) {
  std::vector<double> widths(hits.size());
  std::ranges::transform(hits, widths.begin(), [](const Hit& hit) {
    return static_cast<double>(hit.pulse_last - hit.pulse_first + 1);
  });
  return static_cast<Index>(median(widths));
}

/// Where each block begins and how long it could be; the block's length when it is not given.
void place_blocks(std::span<const Recording> recordings, const HitOptions& options,
                  HitSearch& search) {
  std::vector<Hit>& hits = search.hits;
  const double rate = search.sample_rate_hz;
  const Index width = median_width(hits);
  const auto place = [&](Index pre) {
    for (std::size_t i = 0; i < hits.size(); ++i) {
      Hit& hit = hits[i];
      const bool next = i + 1 < hits.size() && hits[i + 1].recording == hit.recording;
      const Index end = next ? std::max(hit.pulse_last + 1,
                                        hits[i + 1].pulse_first - 2 * (hits[i + 1].pulse_last -
                                                                       hits[i + 1].pulse_first + 1))
                             : recordings[hit.recording].samples();
      hit.block_first = std::max<Index>(0, hit.peak_sample - pre);
      hit.available = end - hit.block_first;
    }
  };
  const auto most_used = [&] {
    double best = 0;
    Index length = 2;
    for (const Hit& candidate : hits) {
      const auto count = std::ranges::count_if(
          hits, [&](const Hit& hit) { return hit.available >= candidate.available; });
      const double used = static_cast<double>(count) * static_cast<double>(candidate.available);
      if (used > best) best = used, length = candidate.available;
    }
    return std::max<Index>(2, length);
  };
  const Index given = static_cast<Index>(std::llround(options.block_s * rate));
  const auto pre_for = [&](Index block) {
    if (options.pre_trigger_s >= 0) {
      return static_cast<Index>(std::llround(options.pre_trigger_s * rate));
    }
    return std::max(block / 100, 2 * width);
  };
  place(2 * width);
  place(pre_for(given > 0 ? given : most_used()));
  search.block_samples = given > 0 ? given : good_fft_length_below(most_used());
  for (const Hit& hit : hits) {  // a block holds at least the pulse
    search.block_samples = std::max(search.block_samples, hit.pulse_last - hit.block_first + 2);
  }
}

void judge_cut_off(std::span<const Recording> recordings, HitSearch& search) {
  for (const Hit& hit : search.hits) {
    if (hit.level_before > 0 && !(search.rest_level > 0 && search.rest_level < hit.level_before)) {
      search.rest_level = hit.level_before;
    }
  }
  for (Hit& hit : search.hits) {
    if (hit.available >= search.block_samples) continue;
    if (hit.end_level <= std::max(kRungDown, 1.5 * search.rest_level)) continue;
    const bool next = hit.block_first + hit.available < recordings[hit.recording].samples();
    hit.reject(HitFault::cut_off,
               fmt::format("ring-down cut off by the {} after {:.4g} s of {:.4g} s, at {:.2g} % of "
                           "its largest value",
                           next ? "next hit" : "end of the record",
                           static_cast<double>(hit.available) / search.sample_rate_hz,
                           static_cast<double>(search.block_samples) / search.sample_rate_hz,
                           100 * hit.end_level));
  }
}

void check_recordings(std::span<const Recording> recordings) {
  for (const Recording& recording : recordings) {
    if (!(recording.sample_rate_hz > 0)) {
      throw file_error(recording.path, "the sample rate is not known",
                       "state it beside the recording (sample_rate_hz)");
    }
    const double first = recordings.front().sample_rate_hz;
    if (std::abs(recording.sample_rate_hz - first) > 1e-5 * first) {
      throw file_error(recording.path,
                       fmt::format("sampled at {:g} Hz, {} at {:g} Hz", recording.sample_rate_hz,
                                   recordings.front().path.string(), first),
                       "average only recordings of one sample rate");
    }
  }
}

int sign_of_most(const std::vector<ForceTrace>& traces, double trigger, Index apart) {
  double sum = 0;
  for (const ForceTrace& trace : traces) {
    for (const Index peak : find_peaks(trace, 0, trigger, apart)) {
      sum += trace.x[peak] > 0 ? 1 : -1;
    }
  }
  return sum < 0 ? -1 : 1;
}

}  // namespace

const char* name_of(HitFault fault) {
  constexpr const char* kNames[] = {
      "rings",      "missing_samples", "overload",       "unresolved_pulse",
      "double_hit", "cut_off",         "force_spectrum", "outlier"};
  return kNames[static_cast<std::size_t>(fault)];
}

bool Hit::has(HitFault fault) const { return std::ranges::find(faults, fault) != faults.end(); }

void Hit::reject(HitFault fault, const std::string& why) {
  accepted = false;
  faults.push_back(fault);
  reason += (reason.empty() ? "" : "; ") + why;
}

HitSearch find_hits(std::span<const Recording> recordings, Index force,
                    std::span<const Index> responses, const HitOptions& options) {
  check_recordings(recordings);
  HitSearch search;
  if (recordings.empty()) return search;
  search.sample_rate_hz = recordings.front().sample_rate_hz;
  const double rate = search.sample_rate_hz;
  const auto apart = static_cast<Index>(std::ceil(kHitWindow * rate));
  const auto channel_of = [&](std::size_t i) -> const Channel& {
    return recordings[i].channels[static_cast<std::size_t>(force)];
  };

  std::vector<ForceTrace> traces;
  for (std::size_t i = 0; i < recordings.size(); ++i) traces.emplace_back(channel_of(i).samples);
  search.sign = sign_of_most(traces, options.trigger, apart);
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    Index earliest = 0;
    const std::vector<Index> peaks = find_peaks(traces[i], search.sign, options.trigger, apart);
    if (peaks.empty()) {
      add_note(search.notes, "no_hit", recordings[i].path.string(),
               "Check the force channel: nothing in \"{}\" rises above the noise",
               channel_of(i).name);
    }
    for (const Index peak : peaks) {
      Hit hit;
      hit.recording = i;
      hit.peak_sample = peak;
      hit.time_s = recordings[i].start_time_s + static_cast<double>(peak) / rate;
      hit.offset = traces[i].offset;
      measure_pulse(channel_of(i).samples, search.sign, rate, earliest, hit);
      earliest = hit.pulse_last + 1;
      search.hits.push_back(std::move(hit));
    }
  }
  if (search.hits.empty()) return search;
  place_blocks(recordings, options, search);

  std::vector<ChannelFacts> force_facts;
  std::vector<std::vector<ChannelFacts>> facts(recordings.size());
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    force_facts.emplace_back(channel_of(i));
    search.response_rest.emplace_back();
    for (const Index channel : responses) {
      facts[i].emplace_back(recordings[i].channels[static_cast<std::size_t>(channel)]);
      search.response_rest.back().push_back(facts[i].back().rest);
    }
  }
  for (Hit& hit : search.hits) {
    const Recording& recording = recordings[hit.recording];
    const Channel& channel = channel_of(hit.recording);
    judge_shape(recording, force, search.block_samples, hit);
    if (hit.has(HitFault::rings)) continue;
    judge_block(recording, force, responses, facts[hit.recording], search.block_samples, hit);
    if (hit.has(HitFault::missing_samples)) continue;
    judge_pulse(recording, channel, force_facts[hit.recording], options, hit);
    judge_double_hit(channel, search.block_samples, search.sign, rate, options.double_hit, hit);
    judge_spectrum(channel.samples, rate, options.band_hz, hit);
    measure_levels(recording, responses, facts[hit.recording], search.block_samples, hit);
  }
  judge_cut_off(recordings, search);
  refuse_all_where_the_largest_rings(search);
  return search;
}

}  // namespace rigfit::signal
