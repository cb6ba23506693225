#include "signal/decay/decay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "signal/decay/decay_clipping.h"
#include "signal/decay/decay_description.h"
#include "signal/decay/decay_judgement.h"
#include "signal/numerics/numbers.h"
#include "signal/sinusoids/damped_sinusoids.h"
#include "signal/sinusoids/decay_modes.h"
#include "signal/sinusoids/decay_search.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
// After this many time constants of the slowest mode a record holds nothing but noise.
constexpr double kTailTimeConstants = 10;
// One damped sinusoid with offset and drift has 6 unknowns.
constexpr Index kFewestSamples = 7;
// The start is moved by so many cycles or time constants at most.
constexpr double kMostCycles = 3, kMostTimeConstants = 0.35;

DecayBand band_of(const DecayOptions& options, double rate) {
  const double nyquist = 0.5 * rate, low = options.band_low_hz, high = options.band_high_hz;
  const bool banded = low > 0 || high > 0;
  if (!(low >= 0) || (banded && high > 0 && !(low < high))) {
    throw std::invalid_argument("decay: the band must rise from zero or above");
  }
  return {low / rate, (high > 0 ? std::min(high, nyquist) : nyquist) / rate, !banded};
}

/// One estimate, step by step.
class Estimation {
 public:
  Estimation(const Eigen::Ref<const Eigen::VectorXd>& y, double rate, const DecayOptions& options,
             const DecayBand& band)
      : rate_(rate),
        options_(options),
        band_(band),
        search_{options.max_modes, options.false_alarm} {
    if (options.time_s.size() == 0) {
      record_ = even_samples(y);
    } else {
      record_.even = false;
      record_.t = (options.time_s.array() - options.time_s(0)) * rate;
      record_.y = y;
      record_.span = static_cast<Index>(std::ceil(record_.t(y.size() - 1))) + 1;
      for (Index j = y.size(); j-- > 0;) {
        if (!std::isfinite(y(j))) record_ = without(record_, {j});
      }
    }
    result_.end = record_.span;
  }

  DecayResult run() {
    if (!usable()) return result_;
    choose_window();
    if (!take_samples() || !find_modes() || !leave_out_clipped()) return result_;
    leave_out_the_tail();
    if (options_.trim_start) trim_start();
    if (moved_start_) {
      note(result_, "start_chosen",
           fmt::format("the fit starts at {:.6g} s, after the impact or release",
                       time_of(result_.start)));
    }
    if (!fit_->usable()) {
      refuse(result_, "not_determined",
             "the modes cannot be told apart in so short a record: record longer");
      return result_;
    }
    describe_decay(result_, *fit_, band_, rate_, options_.envelope);
    judge_decay(result_, *fit_, rate_, options_.false_alarm);
    if (result_.refusal_code.empty()) warn_of_tone();
    return result_;
  }

 private:
  bool usable() {
    if (!(band_.low < band_.high)) {
      refuse(result_, "band_not_sampled",
             fmt::format("the band begins at {:.6g} Hz, above half the sample rate, {:.6g} Hz: "
                         "give a lower one or sample faster",
                         options_.band_low_hz, 0.5 * rate_));
      return false;
    }
    if (record_.t.size() < kFewestSamples) {
      refuse(result_, "too_few_samples",
             fmt::format("{} samples: one damped sinusoid with offset and drift has 6 unknowns",
                         record_.t.size()));
      return false;
    }
    const double high = record_.y.maxCoeff(), low = record_.y.minCoeff();
    if (!(high - low > 1e-14 * std::max(std::abs(high), std::abs(low)))) {
      refuse(result_, "constant", "the signal does not change: nothing vibrates in this channel");
      return false;
    }
    const Index recorded = recorded_until(record_.y), last = record_.y.size();
    if (recorded < last) {
      note(result_, "recording_stops",
           fmt::format("the last {} samples are all {:.6g}: the logger had stopped; they are left "
                       "out",
                       last - recorded, record_.y(last - 1)));
      result_.end = static_cast<Index>(std::ceil(record_.t(recorded - 1))) + 1;
      record_.t.conservativeResize(recorded), record_.y.conservativeResize(recorded);
      record_.span = result_.end;
    }
    return true;
  }

  void choose_window() {
    if (!options_.choose_window) {
      result_.decays = {{0, result_.end, false}};
      return;
    }
    Eigen::VectorXd y = record_.trendless();
    if (record_.even && !record_.complete()) {
      y.setConstant(kNaN);
      for (Index j = 0; j < record_.t.size(); ++j)
        y(static_cast<Index>(record_.t(j))) = record_.y(j);
    }
    result_.decays = find_decays(y, band_);
    double most = -1;
    for (std::size_t k = 0; k < result_.decays.size(); ++k) {
      const auto& w = result_.decays[k];
      const DecaySamples samples = samples_of(w.start, w.end);
      if (samples.t.size() < kFewestSamples) continue;
      const double energy = samples.trendless().squaredNorm();
      if (energy > most) most = energy, result_.fitted_decay = k;
    }
    const auto& chosen = result_.decays[result_.fitted_decay];
    result_.start = chosen.start, result_.end = chosen.end;
    moved_start_ = chosen.after_impact;
    if (result_.decays.size() > 1) {
      std::string where;
      for (const auto& w : result_.decays) {
        where += fmt::format("{}{:.4g} to {:.4g} s", where.empty() ? "" : ", ", time_of(w.start),
                             time_of(w.end - 1));
      }
      note(result_, "several_decays",
           fmt::format("{} decays in the record: {}; the strongest is fitted",
                       result_.decays.size(), where));
    }
  }

  [[nodiscard]] DecaySamples samples_of(Index start, Index end) const {
    const auto first = std::lower_bound(record_.t.begin(), record_.t.end(), double(start));
    const auto last = std::lower_bound(first, record_.t.end(), double(end));
    const Index from = first - record_.t.begin(), count = last - first;
    DecaySamples s;
    s.t = record_.t.segment(from, count).array() - static_cast<double>(start);
    s.y = record_.y.segment(from, count);
    s.span = end - start, s.even = record_.even;
    return s;
  }

  bool take_samples() {
    samples_ = samples_of(result_.start, result_.end);
    const Index lost = samples_.even ? samples_.span - samples_.t.size() : 0;
    if (samples_.t.size() < kFewestSamples) {
      refuse(result_, "too_few_samples", "fewer than 7 samples are left after gaps");
    } else if (5 * lost > samples_.span) {
      refuse(result_, "missing_samples",
             fmt::format("{} of {} samples are missing: name a stretch without gaps by start and "
                         "end",
                         lost, samples_.span));
    } else if (lost > 0) {
      note(result_, "missing_samples", fmt::format("{} missing samples are left out", lost));
    }
    return result_.refusal_code.empty();
  }

  bool find_modes(std::optional<Complex> start = std::nullopt) {
    fit_ = find_decay_modes(samples_, band_, search_, start);
    if (fit_) return true;
    refuse(result_, "too_noisy",
           "no oscillation stands out of the noise (or less than half a cycle is recorded): record "
           "longer, strike harder or name the mode's band");
    return false;
  }

  bool leave_out_clipped() {
    const auto clipped = clipped_samples(samples_, *fit_, band_);
    if (clipped.empty()) return true;
    if (2 * static_cast<Index>(clipped.size()) > samples_.t.size()) {
      refuse(result_, "missing_samples",
             fmt::format("{} of {} samples sit on a rail: record with a larger range",
                         clipped.size(), samples_.t.size()));
      return false;
    }
    note(result_, "clipped",
         fmt::format("Record with a larger range: {} of {} samples sit on the rail and are left "
                     "out",
                     clipped.size(), samples_.t.size()));
    const Index from = std::lower_bound(record_.t.begin(), record_.t.end(),
                                        samples_.t(0) + static_cast<double>(result_.start)) -
                       record_.t.begin();
    std::vector<Index> in_record = clipped;
    for (Index& j : in_record) j += from;
    record_ = without(record_, in_record);
    samples_ = without(samples_, clipped);
    return find_modes(fit_->poles[strongest_mode(*fit_, band_)]);
  }

  // Behind what the slowest mode has left the record only costs time and invites drift.
  void leave_out_the_tail() {
    double slowest = std::numeric_limits<double>::infinity();
    for (const Complex p : fit_->poles) slowest = std::min(slowest, -p.real());
    const double tail = kTailTimeConstants / std::max(slowest, 1e-300);
    if (!(tail < 0.8 * static_cast<double>(fit_->samples) &&
          tail > 24.0 * static_cast<double>(fit_->poles.size()))) {
      return;
    }
    const Index end = result_.start + static_cast<Index>(std::ceil(tail));
    const DecaySamples shorter = samples_of(result_.start, end);
    auto again = refitted(shorter);
    if (!again.usable()) return;
    result_.end = end, samples_ = shorter, fit_ = std::move(again);
  }

  [[nodiscard]] DampedSinusoidsFit refitted(const DecaySamples& samples) const {
    DampedSinusoidsOptions options = fitted_band(band_);
    options.relaxation = fit_->relaxation;
    return fit_damped_sinusoids(samples, fit_->poles, options);
  }

  /// How far the start should move: while the first half cycle leaves three times the rms of what
  /// comes after two cycles, the tail of an impact is in it.
  [[nodiscard]] Index start_shift() const {
    const double cycle = kTwoPi / fit_->poles[strongest_mode(*fit_, band_)].imag();
    const auto half = std::max<Index>(3, static_cast<Index>(std::lround(0.5 * cycle)));
    const auto from = static_cast<Index>(std::ceil(2 * cycle));
    if (fit_->samples < from + std::max<Index>(8, static_cast<Index>(3 * cycle))) return 0;
    const auto rest = fit_->residual.tail(fit_->samples - from);
    const double level = rest.squaredNorm() / static_cast<double>(rest.size());
    return fit_->residual.head(half).squaredNorm() > 9 * level * static_cast<double>(half) ? half
                                                                                           : 0;
  }

  void trim_start() {
    const Complex pole = fit_->poles[strongest_mode(*fit_, band_)];
    const double most = std::min(kMostCycles * kTwoPi / pole.imag(),
                                 kMostTimeConstants / std::max(-pole.real(), 1e-300));
    const Index limit = result_.start + static_cast<Index>(most);
    for (bool moved = true; moved;) {
      moved = false;
      // The modes known, refitted, say how far; a search from there whether that is enough.
      Index shift;
      while ((shift = start_shift()) > 0 && result_.start + shift <= limit) {
        const DecaySamples later = samples_of(result_.start + shift, result_.end);
        auto again = refitted(later);
        if (!again.usable()) break;
        result_.start += shift, samples_ = later, fit_ = std::move(again);
        moved = moved_start_ = true;
      }
      if (!moved) return;
      auto anew = find_decay_modes(samples_, band_, search_);
      if (!anew) return;
      fit_ = std::move(anew);
    }
  }

  /// A tone that stands alone before the impact, too near to the mode to be told from it after.
  void warn_of_tone() {
    constexpr Index kFewest = 32;
    const Complex main = fit_->poles[strongest_mode(*fit_, band_)];
    const double cycle = kTwoPi / main.imag();
    const auto quiet = result_.start - static_cast<Index>(std::ceil(2 * std::max(cycle, 8.0)));
    if (result_.fitted_decay > 0 || quiet < kFewest) return;
    DecaySearchOptions search;
    search.damped = false, search.candidates = 1;
    search.energy_over_noise = detection_threshold(quiet, options_.false_alarm);
    const auto lines = search_lines(line_spectrum(samples_of(0, quiet).trendless()), search);
    if (lines.empty()) return;
    const double f = lines.front().pole.imag() / kTwoPi * rate_;
    const double window = static_cast<double>(fit_->samples) / rate_;
    const double width = std::max(4 / window, -3 * main.real() / kTwoPi * rate_);
    const bool apart = std::any_of(
        result_.steady_tones.begin(), result_.steady_tones.end(),
        [&](const DecayMode& tone) { return std::abs(tone.frequency_hz.value - f) < 4 / window; });
    if (apart || std::abs(f - main.imag() / kTwoPi * rate_) > width) return;
    const double share = std::sqrt(2 * lines.front().energy / static_cast<double>(quiet)) /
                         result_.modes.front().amplitude;
    note(result_, "tone_beside",
         fmt::format("Take away the tone at {:.4g} Hz: before the impact it has {:.2g} % of the "
                     "mode's amplitude, and {:.3g} s are too short to tell the two apart",
                     f, 100 * share, window));
  }

  [[nodiscard]] double time_of(Index sample) const {
    return options_.start_time_s + static_cast<double>(sample) / rate_;
  }

  double rate_;
  const DecayOptions& options_;
  DecayBand band_;
  DecayModesOptions search_;
  DecayResult result_;
  DecaySamples record_, samples_;  // the whole, and the stretch that is fitted
  std::optional<DampedSinusoidsFit> fit_;
  bool moved_start_ = false;
};

}  // namespace

DecayResult estimate_decay(const Eigen::Ref<const Eigen::VectorXd>& y, double sample_rate_hz,
                           const DecayOptions& options) {
  if (!(sample_rate_hz > 0) || !std::isfinite(sample_rate_hz)) {
    throw std::invalid_argument("decay: the sample rate must be positive");
  }
  return Estimation(y, sample_rate_hz, options, band_of(options, sample_rate_hz)).run();
}

}  // namespace rigfit::signal
