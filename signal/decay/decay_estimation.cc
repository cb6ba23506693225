#include "signal/decay/decay_steps.h"

#include <gsl/gsl_cdf.h>

#include <iterator>

#include "signal/estimation/robust.h"
#include "signal/recording/add_note.h"

namespace rigfit::signal {
namespace {

// One damped sinusoid with offset and drift has 6 unknowns.
constexpr Index kFewestSamples = 7;

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
  Estimation(const Ref<const VectorXd>& y, double rate, const DecayOptions& options,
             const DecayBand& band)
      : y_(y), rate_(rate), options_(options), band_(band) {
    result_.end = y.size();
  }

  DecayResult run() {
    if (!usable()) return result_;
    choose_window();
    if (!take_samples() || !find_modes() || !leave_out_clipped() || !place_samples()) {
      return result_;
    }
    add_background();
    trim_start();
    if (moved_start_) {
      add_note(result_.notes, "start_chosen", "",
               "the fit starts at {:.6g} s, after the impact or release", time_of(result_.start));
    }
    result_.residual = fit_->residual;
    result_.fitted = fit_->signal();
    judge_decay(*fit_, band_, rate_, result_);
    judge_steps();
    if (std::ssize(result_.modes) >= kMostModes) {
      add_note(
          result_.notes, "more_modes", "",
          "Give a band: {} modes are fitted at once, and what is left of more adds to their errors",
          kMostModes);
    }
    return result_;
  }

 private:
  bool usable() {
    if (!(band_.low < band_.high)) {
      return result_.refuse("band_not_sampled",
                            fmt::format("the band begins at {:.6g} Hz, above half the sample rate, "
                                        "{:.6g} Hz: give a lower one or sample faster",
                                        options_.band_low_hz, 0.5 * rate_));
    }
    const std::vector<double> finite = finite_values(y_);
    if (std::ssize(finite) < kFewestSamples) {
      return result_.refuse(
          "too_few_samples",
          fmt::format("{} samples: one damped sinusoid with offset and drift has 6 unknowns",
                      finite.size()));
    }
    const auto [low, high] = std::ranges::minmax(finite);
    if (!(high - low > 1e-14 * std::max(std::abs(high), std::abs(low)))) {
      return result_.refuse("constant",
                            "the signal does not change: nothing vibrates in this channel");
    }
    const Index recorded = recorded_until(y_);
    if (recorded < y_.size()) {
      add_note(result_.notes, "recording_stops", "",
               "the last {} samples are all {:.6g}: the logger had stopped; they are left out",
               y_.size() - recorded, y_(y_.size() - 1));
      result_.end = recorded;
    }
    return true;
  }

  void choose_window() {
    result_.decays.push_back({0, result_.end});
    if (!options_.choose_window) return;
    result_.decays = find_decays(y_.head(result_.end), band_);
    double most = -1;
    for (std::size_t k = 0; k < result_.decays.size(); ++k) {
      const auto& w = result_.decays[k];
      if (w.end - w.start < kFewestSamples) continue;
      const double energy = without_trend(y_.segment(w.start, w.end - w.start)).squaredNorm();
      if (energy > most) most = energy, result_.fitted_decay = k;
    }
    const auto& chosen = result_.decays[result_.fitted_decay];
    result_.start = chosen.start, result_.end = chosen.end;
    moved_start_ = chosen.start > 0;
    if (result_.decays.size() > 1) {
      std::string where;
      for (const auto& w : result_.decays) {
        where += fmt::format("{}{:.4g} to {:.4g} s", where.empty() ? "" : ", ", time_of(w.start),
                             time_of(w.end - 1));
      }
      add_note(result_.notes, "several_decays", "",
               "{} decays in the record: {}; the strongest is fitted", result_.decays.size(),
               where);
    }
  }

  bool enough() {
    const auto lost = static_cast<Index>(samples_.missing.size());
    if (samples_.values.size() - lost >= kFewestSamples) return true;
    return result_.refuse("too_few_samples",
                          "fewer than 7 samples are left after clipping and gaps");
  }

  /// To the window's end, with what other samples say.
  [[nodiscard]] DecaySamples samples_from(Index start) const {
    DecaySamples samples = decay_samples(y_, start, result_.end);
    for (const KnownTone& tone : tones_) samples.known.push_back(tone.at(start - tones_from_));
    return samples;
  }

  bool take_samples() {
    samples_ = samples_from(result_.start);
    if (!enough()) return false;
    const auto lost = static_cast<Index>(samples_.missing.size());
    if (5 * lost > samples_.values.size()) {
      return result_.refuse(
          "missing_samples",
          fmt::format("{} of {} samples are missing: name a stretch without gaps by start and end",
                      lost, samples_.values.size()));
    }
    if (lost > 0) {
      add_note(result_.notes, "missing_samples", "", "{} missing samples were left out", lost);
    }
    return true;
  }

  bool find_modes() {
    fit_ = find_decay_modes(samples_, band_);
    if (fit_) return true;
    return result_.refuse(
        "too_noisy",
        "no oscillation stands out of the noise (or less than half a cycle is recorded): a longer "
        "record, a harder impulse or a band around the mode would help");
  }

  bool leave_out_clipped() {
    const auto clipped = clipped_by_fit(samples_, band_);
    if (clipped.empty()) return true;
    for (const Index j : clipped) y_(result_.start + j) = kNaN;
    add_note(result_.notes, "clipped", "",
             "{} samples are cut off at a rail, the last at {:.6g} s; they count as missing",
             clipped.size(), time_of(result_.start + *std::ranges::max_element(clipped)));
    samples_ = samples_from(result_.start);
    return enough() && find_modes();
  }

  /// Takes each sample from its own time to its place by what was found, until what the fit leaves
  /// stays within a hundredth: the noise's std is then known to half of that. Six times serve at 80
  /// dB with times off by 0.3 steps, after three one in four still has false modes.
  bool place_samples() {
    const VectorXd given = y_;
    double left = 0;
    for (int turn = 0; turn < 12 && options_.late.size() > 0; ++turn) {
      if (std::abs(fit_->residual_sum_squares - left) < 0.01 * left) break;
      left = fit_->residual_sum_squares;
      for (Index j = 0; j < fit_->samples; ++j) {
        const Index at = result_.start + j;
        y_(at) = given(at) - fit_->change(static_cast<double>(j), options_.late(at));
      }
      samples_ = samples_from(result_.start);
      if (!find_modes()) return false;
    }
    return true;
  }

  // Steady tones and an offset that dies away; more modes are looked for beside them.
  void add_background() {
    Index quiet = 0;
    if (result_.fitted_decay == 0 && moved_start_) {
      // A cycle and a half before the impact belongs to it.
      const double cycle = kTwoPi / fit_->poles[strongest_mode(*fit_, band_)].imag();
      quiet = std::max<Index>(
          0,
          result_.start - static_cast<Index>(std::ceil(0.5 * cycle + 1.5 * std::max(cycle, 8.0))));
    }
    // Twice: the first modes may hold one that is spent on a tone.
    for (int turn = 0; turn < 2; ++turn) {
      tones_ = steady_tones(y_, quiet, result_.start, result_.end, *fit_);
      tones_from_ = result_.start;
      samples_ = samples_from(result_.start);
      std::vector<Complex> tones;
      for (const KnownTone& tone : tones_) tones.emplace_back(0, tone.value(2));
      if (tones.empty() || !look_beside(tones)) break;
    }
    const auto joint = with_offset(samples_, *fit_);
    if (!joint) return;
    std::vector<Complex> poles;
    std::ranges::copy_if(joint->poles, std::back_inserter(poles),
                         [](Complex p) { return is_tone(p) || is_offset(p); });
    if (!look_beside(poles)) return;
    add_note(result_.notes, "decaying_offset", "",
             "an offset of {:.4g} that dies away with a time constant of {:.3g} s was fitted with "
             "the modes (an amplifier's high-pass?)",
             joint->amplitudes.back().real(), -1 / (joint->poles.back().real() * rate_));
  }

  /// The strongest mode that was not spent on one of `poles`, tones and an offset, and what more
  /// stands out beside these; false where they cannot be told apart, or none is left.
  bool look_beside(std::vector<Complex> poles) {
    const auto n = static_cast<double>(fit_->samples);
    double most = 0;
    std::optional<Complex> strongest;
    for (std::size_t m = 0; m < fit_->poles.size(); ++m) {
      const Complex pole = fit_->poles[m];
      const bool spent = std::ranges::any_of(poles, [&](Complex other) {
        return std::abs(pole.imag() - other.imag()) < kTwoPi / n && std::abs(pole.real()) * n < 0.3;
      });
      const double energy = spent || is_offset(pole) ? 0 : mode_energy(*fit_, m);
      if (energy > most) most = energy, strongest = pole;
    }
    if (!strongest) return false;
    poles.push_back(*strongest);
    auto fit = find_decay_modes(samples_, band_, poles);
    if (!fit) return false;
    fit_ = std::move(fit);
    return true;
  }

  // Moves the start on by half a cycle of the strongest mode at a time, while the first half cycle
  // leaves more than noise of what comes later would, by three cycles or 0.35 time constants at
  // most.
  void trim_start() {
    if (!options_.trim_start) return;
    const Complex pole = fit_->poles[strongest_mode(*fit_, band_)];
    const double most = std::min(3 * kTwoPi / pole.imag(), 0.35 / std::max(-pole.real(), 1e-300));
    const Index first = result_.start;
    while (const Index shift = start_shift()) {
      const Index next = result_.start + shift;
      if (static_cast<double>(next - first) > most) return;
      DecaySamples samples = samples_from(next);
      const bool beside =
          std::ranges::any_of(fit_->poles, [](Complex p) { return is_tone(p) || is_offset(p); });
      auto fit = find_decay_modes(samples, band_, beside ? fit_->poles : std::vector<Complex>());
      if (!fit) return;
      result_.start = next, samples_ = std::move(samples), fit_ = std::move(fit);
      moved_start_ = true;
    }
  }

  [[nodiscard]] Index start_shift() const {
    const double cycle = kTwoPi / fit_->poles[strongest_mode(*fit_, band_)].imag();
    const auto half = std::max<Index>(3, static_cast<Index>(std::lround(0.5 * cycle)));
    const auto rest_from = static_cast<Index>(std::ceil(2 * cycle));
    if (fit_->samples < rest_from + std::max<Index>(8, static_cast<Index>(3 * cycle))) return 0;
    const auto rest = fit_->residual.tail(fit_->samples - rest_from);
    const double level = rest.squaredNorm() / static_cast<double>(rest.size());
    const double first = fit_->residual.head(half).squaredNorm();
    return first > level * gsl_cdf_chisq_Qinv(1e-6, static_cast<double>(half)) ? half : 0;
  }

  /// Notes steps of the converter that the noise does not blur: with noise of half a step the mean
  /// of a rounded value follows the motion to exp(-pi^2 / 2) / pi = 0.2 % of a step. Fifteen steps
  /// in the motion: between ten, where intervals are too narrow, and twenty, where they hold.
  void judge_steps() {
    const double motion = result_.fitted.cwiseAbs().maxCoeff();
    double step = std::numeric_limits<double>::infinity();
    for (Index j = result_.start + 1; j < result_.end; ++j) {
      const double change = std::abs(y_(j) - y_(j - 1));
      if (change > 1e-6 * motion) step = std::min(step, change);
    }
    if (motion > 15 * step || result_.noise_std > step * std::sqrt(1.0 / 4 + 1.0 / 12)) return;
    add_note(
        result_.notes, "coarse_quantisation", "",
        "Use a smaller range: the motion has {:.2g} steps of {:.3g} and too little noise to blur "
        "them, so that intervals are too narrow",
        motion / step, step);
  }

  [[nodiscard]] double time_of(Index sample) const {
    return options_.start_time_s + static_cast<double>(sample) / rate_;
  }

  VectorXd y_;
  double rate_;
  const DecayOptions& options_;
  DecayBand band_;
  DecayResult result_;
  DecaySamples samples_;
  std::optional<DampedSinusoidsFit> fit_;
  std::vector<KnownTone> tones_;  // amplitudes at `tones_from_`, a sample of the record
  Index tones_from_ = 0;
  bool moved_start_ = false;
};

/// From the samples of `narrow` to those of its record.
void take_back(const NarrowRecord& narrow, DecayResult& result) {
  for (DecayMode& mode : result.modes) mode.energy *= static_cast<double>(narrow.step);
  for (DecayWindow& window : result.decays) {
    window.start = narrow.record_sample(window.start);
    window.end = narrow.record_sample(window.end - 1) + 1;
  }
  result.start = narrow.record_sample(result.start);
  result.end = narrow.record_sample(result.end - 1) + 1;
  result.noise_std /= narrow.noise_gain;
  result.signal_to_noise_db += 20 * std::log10(narrow.noise_gain);
  result.step = narrow.step;
  add_note(result.notes, "fitted_in_band", "",
           "every {}th sample was fitted, behind a filter: what counts lies far below the sample "
           "rate",
           narrow.step);
}

}  // namespace

DecayResult estimate_decay(const Ref<const VectorXd>& y, double sample_rate_hz,
                           const DecayOptions& options) {
  if (!(sample_rate_hz > 0) || !std::isfinite(sample_rate_hz)) {
    throw std::invalid_argument("decay: the sample rate must be positive");
  }
  const DecayBand band = band_of(options, sample_rate_hz);
  if (const auto narrow = options.late.size() > 0 ? std::nullopt : narrow_record(y, band)) {
    const double rate = sample_rate_hz / static_cast<double>(narrow->step);
    DecayOptions there = options;
    there.start_time_s += static_cast<double>(narrow->first) / sample_rate_hz;
    DecayResult result = Estimation(narrow->samples, rate, there, band_of(options, rate)).run();
    // A refusal is for the whole record to give.
    if (result.refusal_code.empty()) {
      take_back(*narrow, result);
      return result;
    }
  }
  return Estimation(y, sample_rate_hz, options, band).run();
}

}  // namespace rigfit::signal
