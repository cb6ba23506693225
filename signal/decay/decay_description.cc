#include "signal/decay/decay_description.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "signal/decay/decay_excitation.h"
#include "signal/decay/decay_judgement.h"
#include "signal/decay/decay_warnings.h"
#include "signal/envelope/envelope.h"
#include "signal/numerics/numbers.h"
#include "signal/sinusoids/decay_search.h"
#include "signal/sinusoids/residual_noise.h"
#include "signal/sinusoids/uneven_noise.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Frequency and damping of every mode and their joint covariance, from the fit's.
Eigen::MatrixXd mode_jacobian(const DampedSinusoidsFit& fit, double rate) {
  const auto modes = static_cast<Index>(fit.poles.size());
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(2 * modes, 4 * modes + 2);
  for (Index m = 0; m < modes; ++m) {
    const Complex p = fit.poles[static_cast<std::size_t>(m)];
    const double s = p.real(), w = p.imag(), r = std::abs(p);
    jacobian(2 * m, 4 * m + 2) = rate / kTwoPi * s / r;
    jacobian(2 * m, 4 * m + 3) = rate / kTwoPi * w / r;
    jacobian(2 * m + 1, 4 * m + 2) = -w * w / (r * r * r);
    jacobian(2 * m + 1, 4 * m + 3) = s * w / (r * r * r);
  }
  return jacobian;
}

/// How far the residual's density within the mode's line exceeds `variance`, 1 where noise would
/// show as much. Its two middle lines are left out: there the fit takes the residual away.
double local_excess(const LineSpectrum& residual, Complex pole, double variance) {
  const auto n = static_cast<double>(residual.samples);
  const double reach = std::max(4.0, -2 * pole.real() / kTwoPi * n);  // lines of 1 / N
  const double centre = pole.imag() / kTwoPi * residual.lines_per_cycle;
  const double per_line = residual.lines_per_cycle / n;
  double sum = 0;
  Index count = 0;
  const auto first = std::max<Index>(1, static_cast<Index>(std::ceil(centre - reach * per_line)));
  const auto last = std::min<Index>(residual.power.size() - 1,
                                    static_cast<Index>(std::floor(centre + reach * per_line)));
  for (Index k = first; k <= last; ++k) {
    if (std::abs(static_cast<double>(k) - centre) < per_line) continue;
    sum += residual.power(k), ++count;
  }
  if (count == 0) return 1;
  const double ratio = 0.5 * sum / static_cast<double>(count) / std::max(variance, 1e-300);
  const double degrees = 2 * static_cast<double>(count) / per_line;
  // The density beside the mode is itself known to some ten per cent only.
  return ratio * degrees > 1.3 * gsl_cdf_chisq_Qinv(1e-4, degrees) ? ratio : 1;
}

class Description {
 public:
  Description(DecayResult& result, const DampedSinusoidsFit& fit, const DecayBand& band,
              double rate_hz, const DecayOptions& options)
      : result_(result),
        fit_(fit),
        band_(band),
        rate_(rate_hz),
        options_(options),
        noise_(residual_noise(fit.residual, fit.degrees)),
        uneven_(uneven_noise(fit, noise_)),
        covariance_(uneven_.widened(fit_covariance(fit, noise_))),
        of_modes_(mode_jacobian(fit, rate_hz) * covariance_ *
                  mode_jacobian(fit, rate_hz).transpose()),
        spectrum_(line_spectrum(fit.residual)),
        all_(fit.poles.size()) {}

  void run() {
    describe_noise();
    for (std::size_t m = 0; m < all_.size(); ++m) describe_mode(m);
    if (!keep_what_decays()) return;
    for (const std::size_t m : kept_) judge_alone(m);
    if (refuse_doubtful() || driven()) return;
    const auto count = static_cast<Index>(kept_.size());
    result_.covariance.resize(2 * count, 2 * count);
    for (Index i = 0; i < count; ++i) {
      for (Index k = 0; k < count; ++k) {
        result_.covariance.block<2, 2>(2 * i, 2 * k) =
            of_modes_.block<2, 2>(2 * static_cast<Index>(kept_[static_cast<std::size_t>(i)]),
                                  2 * static_cast<Index>(kept_[static_cast<std::size_t>(k)]));
      }
    }
    widen_by_what_is_left();
    for (const std::size_t m : kept_) {
      note_uneven_noise(m);
      result_.modes.push_back(finished(all_[m]));
    }
    const std::size_t main = kept_.front();
    result_.signal_to_noise_db =
        10 * std::log10(0.5 * std::norm(fit_.amplitudes[main]) / std::max(noise_.variance, 1e-300));
  }

 private:
  void describe_noise() {
    result_.offset = fit_.offset;
    result_.drift_per_s = fit_.drift / static_cast<double>(fit_.samples) * rate_;
    result_.noise_std = std::sqrt(noise_.variance);
    result_.residual_order = noise_.coefficients.size();
    result_.degrees_of_freedom = fit_.degrees;
    result_.coverage_factor_95 = gsl_cdf_tdist_Pinv(0.975, static_cast<double>(fit_.degrees));
    result_.residual = fit_.residual;
  }

  void describe_mode(std::size_t m) {
    DecayMode& mode = all_[m];
    const auto k = static_cast<Index>(2 * m), w = static_cast<Index>(4 * m + 3);
    const Complex p = fit_.poles[m];
    mode.frequency_hz = {std::abs(p) * rate_ / kTwoPi, std::sqrt(of_modes_(k, k))};
    mode.damping_ratio = {damping_ratio_of(p), std::sqrt(of_modes_(k + 1, k + 1))};
    mode.correlation = of_modes_(k, k + 1) / std::sqrt(of_modes_(k, k) * of_modes_(k + 1, k + 1));
    mode.damped_frequency_hz = {p.imag() * rate_ / kTwoPi,
                                std::sqrt(covariance_(w, w)) * rate_ / kTwoPi};
    mode.amplitude = std::abs(fit_.amplitudes[m]);
    mode.phase_rad = std::arg(fit_.amplitudes[m]);
    mode.energy = mode_energy(fit_, m);
    const double threshold = detection_threshold(fit_.samples, options_.false_alarm);
    mode.detection =
        mode.energy /
        std::max(threshold * noise_.white_equivalent(fit_.poles[m].imag() / kTwoPi), 1e-300);
    mode.cycles = mode.damped_frequency_hz.value * static_cast<double>(fit_.samples) / rate_;
  }

  /// Time constants in the window, and their standard uncertainty.
  [[nodiscard]] double fall(std::size_t m) const {
    return -fit_.poles[m].real() * static_cast<double>(fit_.samples);
  }
  [[nodiscard]] double fall_std(std::size_t m) const {
    const auto s = static_cast<Index>(4 * m + 2);
    return std::sqrt(covariance_(s, s)) * static_cast<double>(fit_.samples);
  }
  [[nodiscard]] bool grows(std::size_t m) const {
    return fall(m) < -0.05 && fall(m) + 3 * fall_std(m) < 0;
  }

  /// Known to fall by less than `kSteady` over a window that would show a decay.
  [[nodiscard]] bool steady(std::size_t m) const {
    return std::abs(fall(m)) + 2 * fall_std(m) < kSteady && all_[m].cycles > kFewCycles;
  }

  /// Steady tones apart, modes outside of the band and weaker ones that grow left out. False:
  /// refused.
  bool keep_what_decays() {
    std::vector<std::size_t> order(all_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t l, std::size_t r) { return all_[l].energy > all_[r].energy; });
    const bool decays =
        std::any_of(order.begin(), order.end(), [&](std::size_t m) { return fall(m) > 0.5; });
    for (const std::size_t m : order) {
      // Known to change by less than a tenth over the record while others decay: hum.
      if (decays && std::abs(fall(m)) + 2 * fall_std(m) < 0.1) {
        result_.steady_tones.push_back(all_[m]);
        continue;
      }
      if (!band_.contains(fit_.poles[m])) continue;
      if (!grows(m)) {
        kept_.push_back(m);
        continue;
      }
      const double f = all_[m].damped_frequency_hz.value;
      if (kept_.empty()) {
        refuse(result_, "grows",
               fmt::format("the oscillation at {:.6g} Hz grows by a factor of {:.3g} over the "
                           "window: this is no free decay, or two modes beat (name a start and end "
                           "that hold a decay, or a whole beat)",
                           f, std::exp(-fall(m))));
        return false;
      }
      growing_.push_back(m);
      note(
          result_, "grows",
          fmt::format("a weaker oscillation at {:.6g} Hz grows; it is fitted but not reported", f));
    }
    if (!kept_.empty() && steady(kept_.front())) {
      const double f = all_[kept_.front()].damped_frequency_hz.value;
      refuse(result_, "nothing_decays",
             fmt::format("record a free decay (a tap, a release): the oscillation at {:.6g} Hz "
                         "keeps its amplitude within {:.0f} % over the window: a machine, a "
                         "shaker or hum drives it, or the window is too short to show the decay",
                         f, 100 * kSteady));
      return false;
    }
    if (!kept_.empty()) return true;
    refuse(result_, "no_decay",
           result_.steady_tones.empty() ? "no oscillation in the band"
                                        : "only steady tones in the band, nothing that decays");
    return false;
  }

  /// White-equivalent variance beside the mode: what the fit leaves at the mode itself is not
  /// noise.
  [[nodiscard]] double noise_beside(double w) const {
    DecaySearchOptions beside;
    beside.damped = false, beside.candidates = 1;
    beside.lowest = std::max(0.0, w / kTwoPi - 0.05);
    beside.highest = std::min(0.5, w / kTwoPi + 0.05);
    const auto floor = search_lines(spectrum_, beside);
    return floor.empty() ? noise_.variance : floor.front().noise_variance;
  }

  /// Ambient or machine excitation in place of a decay: refused. Beside a decay: noted.
  bool driven() {
    const std::size_t main = kept_.front();
    const double f = all_[main].damped_frequency_hz.value;
    const double amplitude = all_[main].amplitude;
    // What a random amplitude looks like to a fit: several modes within a few lines or widths.
    const auto beside = [&](std::size_t m) {
      const double width = std::max(-fit_.poles[main].real(), std::abs(fit_.poles[m].real()));
      const double lines = 4 * kTwoPi / static_cast<double>(fit_.samples);
      return m != main &&
             std::abs(fit_.poles[m].imag() - fit_.poles[main].imag()) < std::max(lines, 3 * width);
    };
    const auto cluster = std::count_if(kept_.begin(), kept_.end(), beside);
    const bool growing = std::any_of(growing_.begin(), growing_.end(), [&](std::size_t m) {
      return beside(m) && all_[m].amplitude * std::exp(-fall(m)) > 0.2 * amplitude;
    });
    const Excitation left =
        excitation_at(fit_.residual, fit_.poles[main].imag(), noise_around(main));
    const bool goes_on = left.significant && left.over_noise > 4 && left.later_share > 0.15;
    if (growing || cluster >= 2 || (goes_on && left.amplitude > kMostExcited * amplitude)) {
      refuse(
          result_, "driven",
          fmt::format(
              "the oscillation at {:.4g} Hz does not die away by itself: {}. Ambient motion or "
              "a machine drives it, and a free decay is needed: a tap, a release, a machine "
              "that is switched off, stronger than what drives it now; or name one by start and "
              "end",
              f,
              growing        ? "its amplitude grows again"
              : cluster >= 2 ? "its amplitude rises and falls at random"
                             : fmt::format("what one decay leaves at its frequency goes on through "
                                           "the record, {:.0f} % of the amplitude at the start",
                                           100 * left.amplitude / amplitude)));
      result_.steady_tones.clear();
      return true;
    }
    if (goes_on && left.amplitude > 0.01 * amplitude) {
      note(result_, "excited",
           fmt::format(
               "what the fit leaves at {:.4g} Hz is no noise and goes on through the record, "
               "{:.2g} % of the amplitude at the start: the mode is excited while it decays, "
               "or has a close neighbour; the intervals allow for it",
               f, 100 * left.amplitude / amplitude));
    }
    return false;
  }

  /// Median density off the mode, where its blocks (decay_excitation.h) see no more of it.
  [[nodiscard]] double noise_around(std::size_t m) const {
    const double w = fit_.poles[m].imag(), f = w / kTwoPi;
    const double block = static_cast<double>(excitation_block(fit_.samples, w));
    // Noise may slope: the side with more of it counts.
    std::vector<double> sides[2];
    for (Index k = 1; k < spectrum_.power.size(); ++k) {
      const double apart = (static_cast<double>(k) / spectrum_.lines_per_cycle - f) * block;
      if (std::abs(apart) > 1 && std::abs(apart) < 4)
        sides[apart > 0].push_back(spectrum_.power(k));
    }
    double most = 0;
    for (auto& powers : sides) {
      if (powers.size() < 8) continue;
      const auto middle = powers.begin() + static_cast<std::ptrdiff_t>(powers.size() / 2);
      std::nth_element(powers.begin(), middle, powers.end());
      // Median of an exponential distribution of mean 2 s^2 is 2 s^2 ln 2.
      most = std::max(most, *middle / (2 * std::numbers::ln2));
    }
    return most > 0 ? most : noise_beside(w);
  }

  /// Where the residual holds more at a mode than its colour says (a mode that changes, a
  /// neighbour, a converter's steps), what is there counts as uncertainty; then the intervals.
  void widen_by_what_is_left() {
    Eigen::VectorXd scale(2 * static_cast<Index>(kept_.size()));
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      DecayMode& mode = all_[kept_[i]];
      const Complex pole = fit_.poles[kept_[i]];
      const double wider = std::sqrt(std::max(
          1.0, local_excess(spectrum_, pole, noise_.white_equivalent(pole.imag() / kTwoPi))));
      scale.segment<2>(2 * static_cast<Index>(i)).setConstant(wider);
      const auto widen = [&](Estimate& estimate) {
        estimate.std *= wider;
        const double half = result_.coverage_factor_95 * estimate.std;
        return Interval{estimate.value - half, estimate.value + half};
      };
      mode.frequency_interval_95_hz = widen(mode.frequency_hz);
      mode.damping_ratio_interval_95 = widen(mode.damping_ratio);
      widen(mode.damped_frequency_hz);
    }
    result_.covariance = scale.asDiagonal() * result_.covariance * scale.asDiagonal();
  }

  /// What the others leave and this mode explains of it.
  void judge_alone(std::size_t m) {
    DecayMode& mode = all_[m];
    Eigen::VectorXd alone = fit_.mode_signal(m);
    alone += fit_.residual;  // zero where samples are missing
    const double spread = (alone.array() - alone.mean()).square().sum();
    mode.r_squared = spread > 0 ? 1 - fit_.residual_sum_squares / spread : 0;
    const auto cycles =
        cycle_amplitudes(alone, rate_, fit_.poles[m], noise_beside(fit_.poles[m].imag()));
    const auto decrement = log_decrement(cycles);
    mode.damping_ratio_log_decrement = decrement.damping_ratio;
    mode.log_decrement_refusal = decrement.refusal;
    if (m == kept_.front()) result_.envelope = envelope_of(cycles);
    doubt_of(mode, alone, fit_.residual, result_.residual_order, options_.false_alarm);
    mode.company = leaves_company(spectrum_, fit_.poles[m], options_.false_alarm);
  }

  /// Unless what is left is no noise: then `company` says so.
  void note_uneven_noise(std::size_t m) {
    const auto part = static_cast<Index>(4 * m + 2);
    const double decay_rate = std::sqrt(uneven_.widening(part));
    const double frequency = std::sqrt(uneven_.widening(part + 1));
    if (all_[m].company || std::max(decay_rate, frequency) <= 1) return;
    note(result_, "uneven_noise",
         fmt::format("the noise is larger where the mode at {:.4g} Hz moves than over the record, "
                     "as under jitter of the sampling clock, noise in proportion to the signal or "
                     "converter steps: uncertainties allow for it, {:.2g} times as wide in "
                     "frequency, {:.2g} times in damping",
                     all_[m].damped_frequency_hz.value, frequency, decay_rate));
  }

  static DecayMode finished(DecayMode mode) {
    // A free oscillation takes no energy in: the likely values are those from zero on.
    auto& zeta = mode.damping_ratio;
    auto& interval = mode.damping_ratio_interval_95;
    if (zeta.value < 0) zeta.value = 0, interval.high = std::max(interval.high, zeta.std);
    interval.low = std::max(0.0, interval.low);
    // d delta / d zeta = 2 pi / (1 - zeta^2)^(3/2)
    const double root = std::sqrt(1 - zeta.value * zeta.value);
    mode.log_decrement = {kTwoPi * zeta.value / root, kTwoPi * zeta.std / (root * root * root)};
    return mode;
  }

  /// When nothing that was found is more than coloured noise would show.
  bool refuse_doubtful() {
    if (!std::all_of(kept_.begin(), kept_.end(), [&](std::size_t m) { return all_[m].doubtful; })) {
      return false;
    }
    const DecayMode& first = all_[kept_.front()];
    if (first.company && first.r_squared > 0.3) {
      refuse(
          result_, "not_separable",
          fmt::format("what one decay leaves near {:.4g} Hz is no noise: two modes that beat too "
                      "slowly for this record, or one that changes; a longer record or less "
                      "noise is needed",
                      first.damped_frequency_hz.value));
    } else {
      refuse(result_, "too_noisy", "no oscillation stands out of the noise: " + first.doubt);
    }
    return true;
  }

  // Mains frequency and machines keep their amplitude to a few per cent; a decay that falls by less
  // has no damping to tell.
  static constexpr double kSteady = 0.02;
  static constexpr double kFewCycles = 10;  // the frequency of fewer is worth having by itself
  // What goes on beside a decay may be as large as this share of it.
  static constexpr double kMostExcited = 0.1;

  DecayResult& result_;
  const DampedSinusoidsFit& fit_;
  const DecayBand& band_;
  double rate_;
  const DecayOptions& options_;
  ResidualNoise noise_;
  UnevenNoise uneven_;
  Eigen::MatrixXd covariance_, of_modes_;
  LineSpectrum spectrum_;
  std::vector<DecayMode> all_;
  std::vector<std::size_t> kept_, growing_;
};

}  // namespace

void describe_decay(DecayResult& result, const DampedSinusoidsFit& fit, const DecayBand& band,
                    double rate_hz, const DecayOptions& options) {
  Description(result, fit, band, rate_hz, options).run();
}

}  // namespace rigfit::signal
