#include "signal/decay/decay_steps.h"

#include <gsl/gsl_cdf.h>

#include "signal/recording/add_note.h"
#include "signal/sinusoids/residual_noise.h"

namespace rigfit::signal {
namespace {

// Energy over the largest that noise shows with probability kFalseAlarm. Estimates that are
// answered only where noise made them larger are biased: at 4 times, 4.5 dB in 50 cycles, by a
// tenth of a standard uncertainty.
constexpr double kLeastDetection = 4;

class Judgement {
 public:
  Judgement(const DampedSinusoidsFit& fit, const DecayBand& band, double rate, DecayResult& result)
      : fit_(fit), band_(band), rate_(rate), result_(result) {}

  void run() {
    describe();
    result_.noise_std = std::sqrt(noise_.variance);
    result_.degrees_of_freedom = fit_.degrees;
    const double amplitude = modes_[strongest_mode(fit_, band_)].amplitude;
    result_.signal_to_noise_db =
        10 * std::log10(0.5 * amplitude * amplitude / std::max(noise_.variance, 1e-300));
    choose();
    if (!accept()) return;
    for (const std::size_t m : kept_) result_.modes.push_back(modes_[m]);
    result_.envelope = envelope_of(cycles_of(kept_.front()));
    say();
  }

 private:
  [[nodiscard]] double hz(std::size_t m) const { return modes_[m].damped_frequency_hz.value; }

  /// White-equivalent variance of a sample beside mode m: what the fit leaves at it is no noise.
  [[nodiscard]] double noise_beside(std::size_t m) const {
    return noise_near(left_, Complex(0, fit_.poles[m].imag()));
  }

  /// Mode m and what no mode explains.
  [[nodiscard]] VectorXd alone(std::size_t m) const {
    return fit_.mode_signal(m) + fit_.residual;  // zero where samples are missing
  }

  [[nodiscard]] CycleAmplitudes cycles_of(std::size_t m) const {
    return cycle_amplitudes(alone(m), rate_, fit_.poles[m], noise_beside(m));
  }

  /// The numbers of all modes, with intervals of the fit's covariance and Student's law.
  void describe() {
    noise_ = residual_noise(fit_.residual, fit_.degrees);
    left_ = line_spectrum(fit_.residual);
    uncertainty_ = fit_uncertainty(fit_, noise_);
    const VectorXd widened = uncertainty_.widening.sqrt();
    const MatrixXd covariance =
        widened.asDiagonal() * uncertainty_.covariance * widened.asDiagonal();
    const double factor = gsl_cdf_tdist_Pinv(0.975, static_cast<double>(fit_.degrees));
    result_.coverage_factor_95 = factor;
    const auto n = static_cast<double>(fit_.samples);
    for (std::size_t m = 0; m < fit_.poles.size(); ++m) {
      const Complex p = fit_.poles[m];
      const auto s = static_cast<Index>(4 * m) + 2, w = s + 1;
      const Eigen::Matrix2d of_pole = covariance.block<2, 2>(s, s);
      const double variance =
          uncertainty_.widening_of_mode(m) * noise_.white_equivalent(p.imag() / kTwoPi);
      fall_.push_back(-p.real() * n), fall_std_.push_back(std::sqrt(covariance(s, s)) * n);

      DecayMode mode;
      const double to_hz = rate_ / kTwoPi;
      // d |p| / d p, and d zeta / d p = Im p / |p|^2 times its normal.
      const Eigen::Vector2d along = Eigen::Vector2d(p.real(), p.imag()) / std::abs(p);
      const Eigen::Vector2d across =
          Eigen::Vector2d(-p.imag(), p.real()) * p.imag() / std::pow(std::abs(p), 3);
      mode.frequency_hz = {std::abs(p) * to_hz, std::sqrt(along.dot(of_pole * along)) * to_hz};
      mode.damping_ratio = {damping_ratio_of(p), std::sqrt(across.dot(of_pole * across))};
      mode.damped_frequency_hz = {p.imag() * to_hz, std::sqrt(covariance(w, w)) * to_hz};
      const auto interval = [&](const Estimate& e) {
        return Interval{e.value - factor * e.std, e.value + factor * e.std};
      };
      mode.frequency_interval_95_hz = interval(mode.frequency_hz);
      // A free oscillation takes no energy in: the likely values are those from zero on. Once the
      // record holds the decay, what the damping is uncertain by grows with it: then its logarithm
      // has the interval.
      auto& zeta = mode.damping_ratio;
      auto& within = mode.damping_ratio_interval_95;
      within = interval(zeta);
      if (zeta.value < 0) zeta.value = 0, within.high = std::max(within.high, zeta.std);
      within.low = std::max(0.0, within.low);
      if (fall_.back() > 1) {
        const double times = std::exp(factor * zeta.std / zeta.value);
        within = {zeta.value / times, zeta.value * times};
      }
      // d delta / d zeta = 2 pi / (1 - zeta^2)^(3/2)
      const double root = std::sqrt(1 - zeta.value * zeta.value);
      mode.log_decrement = {kTwoPi * zeta.value / root, kTwoPi * zeta.std / (root * root * root)};
      mode.amplitude = std::abs(fit_.amplitudes[m]);
      mode.energy = mode_energy(fit_, m);
      mode.detection = mode.energy / std::max(detection_threshold(fit_.samples) * variance, 1e-300);
      mode.cycles = p.imag() / kTwoPi * n;

      const VectorXd with_residual = alone(m);
      const double spread = (with_residual.array() - with_residual.mean()).square().sum();
      mode.r_squared = spread > 0 ? 1 - fit_.residual_sum_squares / spread : 0;
      mode.by_cycles = log_decrement(cycles_of(m));
      modes_.push_back(std::move(mode));
    }
  }

  /// Steady tones apart, modes outside of the band and those that grow left out.
  void choose() {
    std::vector<std::size_t> order;
    for (std::size_t m = 0; m < modes_.size(); ++m) {
      if (!is_offset(fit_.poles[m])) order.push_back(m);
    }
    std::ranges::sort(order, std::greater(), [&](std::size_t m) { return modes_[m].energy; });
    const bool decays = std::ranges::any_of(order, [&](std::size_t m) { return fall_[m] > 0.5; });
    for (const std::size_t m : order) {
      // Hum, or known to change by less than a tenth over the record while others decay.
      if (is_tone(fit_.poles[m]) || (decays && std::abs(fall_[m]) + 2 * fall_std_[m] < 0.1)) {
        result_.steady_tones_hz.push_back(hz(m));
      } else if (band_.contains(fit_.poles[m]) && fit_.poles[m].imag() > fit_.drift_up_to) {
        const bool grows = fall_[m] < -0.05 && fall_[m] + 3 * fall_std_[m] < 0;
        (grows ? growing_ : kept_).push_back(m);
      }
    }
  }

  /// False where the decay is refused.
  bool accept() {
    if (!growing_.empty() &&
        (kept_.empty() || modes_[growing_.front()].energy > modes_[kept_.front()].energy)) {
      const std::size_t m = growing_.front();
      return result_.refuse(
          "no_decay",
          fmt::format("name a start and end that hold a decay, or a whole beat: the oscillation at "
                      "{:.6g} Hz grows by a factor of {:.3g} over the window",
                      hz(m), std::exp(-fall_[m])));
    }
    if (kept_.empty()) {
      return result_.refuse("no_decay", result_.steady_tones_hz.empty()
                                            ? "no oscillation in the band"
                                            : "only steady tones in the band, nothing that decays");
    }
    const std::size_t main = kept_.front();
    const DecayMode& mode = modes_[main];
    if (const std::string why = driven(); !why.empty()) {
      return result_.refuse(
          "no_decay",
          fmt::format(
              "record a free decay (a tap, a release, a machine that is switched off) or name one "
              "by start and end: the oscillation at {:.4g} Hz does not die away by itself: {}",
              hz(main), why));
    }
    if (!std::isfinite(mode.damping_ratio.std) || mode.cycles < 1) {
      return result_.refuse(
          "too_noisy",
          fmt::format(
              "record more cycles or less noise: the record holds {:.2g} cycles at {:.3g} dB, "
              "which leave frequency and damping at {:.4g} Hz undetermined beside offset and drift",
              mode.cycles, result_.signal_to_noise_db, mode.frequency_hz.value));
    }
    // A mode that explains most of what is there is no noise: what it leaves has its own colour.
    if (mode.detection < kLeastDetection && mode.r_squared < 0.8) {
      return result_.refuse(
          "too_noisy",
          fmt::format("repeat the test with a harder blow or a longer record, or give a "
                      "band around the mode: the oscillation at {:.4g} Hz has {:.2g} "
                      "times the energy that noise alone may show, and below {:.2g} "
                      "times the values that are seen are those which noise made larger",
                      mode.frequency_hz.value, mode.detection, kLeastDetection));
    }
    return true;
  }

  /// Why the strongest mode is no free decay; empty when it is one.
  [[nodiscard]] std::string driven() const {
    const std::size_t main = kept_.front();
    const Complex strongest = fit_.poles[main];
    const double amplitude = modes_[main].amplitude;
    // What a random amplitude looks like to a fit: several modes within a few lines or widths.
    const auto near = [&](Complex pole) {
      const double width = std::max(-strongest.real(), std::abs(pole.real()));
      const double lines = 4 * kTwoPi / static_cast<double>(fit_.samples);
      return std::abs(pole.imag() - strongest.imag()) < std::max(lines, 3 * width);
    };
    const auto beside = [&](std::size_t m) { return m != main && near(fit_.poles[m]); };
    if (std::ranges::any_of(growing_, [&](std::size_t m) {
          return beside(m) && modes_[m].amplitude * std::exp(-fall_[m]) > 0.2 * amplitude;
        })) {
      return "its amplitude grows again";
    }
    // Noise whose colour is that of the residual beside them passes for some of them.
    if (std::ranges::count_if(kept_, beside) + std::ranges::count_if(fit_.noise_like, near) >= 2) {
      return "its amplitude rises and falls at random";
    }
    return {};
  }

  /// Whether mode m leaves what an amplitude and a phase that depart from an exponential, with t^2
  /// and t^3, take out, and noise would not (four unknowns; noise may be larger while the mode
  /// lasts): a second mode that beats too slowly for the record, or a change along the decay.
  [[nodiscard]] bool leaves_company(std::size_t m) const {
    return fit_.residual.squaredNorm() - departing_residual(fit_, std::span(&m, 1)) >
           gsl_cdf_chisq_Qinv(1e-4, 4) * uncertainty_.widening_of_mode(m) * noise_beside(m);
  }

  /// Whether resonances touch: a third of a beat a time constant tells two modes from one that
  /// changes no better than what is left of one does.
  [[nodiscard]] bool overlapped(std::size_t m) const {
    const auto& poles = fit_.poles;
    return std::ranges::any_of(kept_, [&](std::size_t other) {
      return other != m && std::abs(poles[other].imag() - poles[m].imag()) <
                               -poles[other].real() - poles[m].real();
    });
  }

  void say() {
    const DecayMode& mode = result_.modes.front();
    if (!(mode.damping_ratio.value > 2 * mode.damping_ratio.std)) {
      add_note(
          result_.notes, "damping_not_resolved", "",
          "damping ratio {:.3g} is not distinguishable from zero (standard uncertainty {:.2g})",
          mode.damping_ratio.value, mode.damping_ratio.std);
    }
    for (const std::size_t m : kept_) {
      if (!leaves_company(m) && !overlapped(m)) continue;
      add_note(result_.notes, "not_one_decay", "",
               "Record for longer, or look for a change during the decay: one exponential does not "
               "hold all that decays near {:.4g} Hz: there is a mode close by that beats too "
               "slowly for this record, one that changes as it decays, or excitation that goes on",
               hz(m));
    }
    say_whether_exponential(mode);
    if (fit_.drift_up_to > 0) {
      add_note(result_.notes, "slow_drift", "",
               "Record for longer if modes up to {:.2g} Hz matter: what is there is no more than a "
               "drift, which was fitted with the modes",
               fit_.drift_up_to * rate_ / kTwoPi);
    }
    for (const double tone : result_.steady_tones_hz) {
      add_note(result_.notes, "steady_tone", "",
               "a steady tone at {:.6g} Hz (mains hum?) was fitted and kept out of the modes",
               tone);
    }
  }

  void say_whether_exponential(const DecayMode& mode) {
    const auto& envelope = result_.envelope;
    const auto& drift = envelope.frequency_drift_hz;
    const bool drifts = std::isfinite(drift.std) && std::abs(drift.value) > 5 * drift.std &&
                        std::abs(drift.value) > 2 * mode.frequency_hz.std;
    if (envelope.law == DecayLaw::exponential && !drifts) return;
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const auto& p : envelope.points) {
      least = std::min(least, p.damping_ratio.value), most = std::max(most, p.damping_ratio.value);
    }
    add_note(result_.notes, "not_exponential", "",
             "The numbers hold for one amplitude only: damping {} as the motion dies, damping "
             "ratio {:.3g} to {:.3g} along the decay, and the frequency changes by {:+.2g} Hz from "
             "its first part to its last",
             envelope.law == DecayLaw::friction ? "rises (as under dry friction)"
             : envelope.law == DecayLaw::drag   ? "falls (as under drag)"
                                                : "stays",
             least, most, drift.value);
  }

  const DampedSinusoidsFit& fit_;
  const DecayBand& band_;
  double rate_;
  DecayResult& result_;
  // In coloured noise, and noise that is larger while a mode moves (residual_noise.h).
  ResidualNoise noise_;
  FitUncertainty uncertainty_;
  LineSpectrum left_;             // the residual has
  std::vector<DecayMode> modes_;  // order of the fit, an offset among them
  // Time constants in the window, and their standard uncertainty, by mode.
  std::vector<double> fall_, fall_std_;
  std::vector<std::size_t> kept_, growing_;  // strongest first
};

}  // namespace

void judge_decay(const DampedSinusoidsFit& fit, const DecayBand& band, double sample_rate_hz,
                 DecayResult& result) {
  Judgement(fit, band, sample_rate_hz, result).run();
}

}  // namespace rigfit::signal
