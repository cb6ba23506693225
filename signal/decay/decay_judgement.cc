#include "signal/decay/decay_judgement.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "signal/decay/decay_hits.h"
#include "signal/numerics/factorisations.h"
#include "signal/numerics/numbers.h"
#include "signal/sinusoids/decay_search.h"
#include "signal/sinusoids/residual_noise.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// What goes on beside a decay may be as large as this share of it.
constexpr double kMostExcited = 0.1;
// Energy over the largest that noise shows with probability kFalseAlarm. Estimates that are
// answered only where noise made them larger are biased: at 4 times, 4.5 dB in 50 cycles, by a
// tenth of a standard uncertainty.
constexpr double kLeastDetection = 4;
// An amplitude that falls by less is known from its start alone.
constexpr double kShortFall = 0.7;

/// The numbers of a fit: its modes with uncertainties, in coloured noise and noise that is larger
/// while the mode moves (residual_noise.h), the log decrement and the envelope of each.
struct DescribedFit {
  const DampedSinusoidsFit& fit;
  ResidualNoise noise;
  LineSpectrum residual;                  // what the fit leaves
  std::vector<DecayMode> modes;           // order of the fit, an offset among them
  std::vector<EnvelopeResult> envelopes;  // by mode
  Eigen::MatrixXd covariance;             // of (f_1, zeta_1, f_2, ...), Hz and 1
  // Time constants in the window, and their standard uncertainty, by mode.
  std::vector<double> fall, fall_std;

  /// White-equivalent variance of a sample beside the angular frequency `w`: what the fit leaves at
  /// a mode itself is no noise.
  [[nodiscard]] double noise_beside(double w) const { return noise_near(residual, Complex(0, w)); }
};

// d (f, zeta) of every mode / d parameters of the fit.
Eigen::MatrixXd mode_jacobian(const DampedSinusoidsFit& fit, double rate) {
  const auto modes = static_cast<Index>(fit.poles.size());
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(2 * modes, fit.unit_covariance.rows());
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

/// Whether mode m leaves what an amplitude and a phase that depart from an exponential, with t^2
/// and t^3, take out, and noise would not (four unknowns; noise may be larger while the mode
/// lasts).
bool leaves_company(const DampedSinusoidsFit& fit, std::size_t m, double noise_variance,
                    const FitUncertainty& uncertainty) {
  const double left = departing_residual(fit, {}, std::span(&m, 1));
  return fit.residual_sum_squares - left >
         gsl_cdf_chisq_Qinv(1e-4, 4) * uncertainty.widening_of_mode(m) * noise_variance;
}

/// Whether coloured noise passes for the mode: `alone`, what the other modes leave, is as well
/// predicted by an autoregression of the residual's own order. (Likelihood ratio, four unknowns,
/// over all cells of the search.)
std::string doubt_of(const DecayMode& mode, const Eigen::VectorXd& alone,
                     const Eigen::VectorXd& residual, Index order) {
  // A mode that explains most of what is there is no noise; its residual's colour is its own.
  if (order == 0 || mode.r_squared > 0.8) return {};
  const double without = prediction_error(alone, order), with = prediction_error(residual, order);
  if (!(with > 0)) return {};
  const double gain = static_cast<double>(alone.size()) * std::log(without / with);
  // exp(threshold / 2) is the number of cells over the false alarm.
  const double chance = std::exp(-0.5 * detection_threshold(alone.size()));
  const double needed = gsl_cdf_chisq_Qinv(chance, 4);
  if (gain > needed) return {};
  return fmt::format(
      "noise of the colour of the residual would show as much at {:.4g} Hz (evidence {:.2g} of "
      "what is asked for)",
      mode.damped_frequency_hz.value, std::max(0.0, gain) / needed);
}

/// Intervals are those of the fit's covariance and Student's law.
DescribedFit describe_fit(const DampedSinusoidsFit& fit, double rate) {
  DescribedFit out{fit, {}, {}, {}, {}, {}, {}, {}};
  out.noise = residual_noise(fit.residual, fit.degrees);
  out.residual = line_spectrum(fit.residual);
  const FitUncertainty uncertainty = fit_uncertainty(fit, out.noise);
  const Eigen::MatrixXd covariance = uncertainty.widened();
  const Eigen::MatrixXd jacobian = mode_jacobian(fit, rate);
  out.covariance = jacobian * covariance * jacobian.transpose();
  const double factor = gsl_cdf_tdist_Pinv(0.975, static_cast<double>(fit.degrees));
  const auto n = static_cast<double>(fit.samples);
  for (std::size_t m = 0; m < fit.poles.size(); ++m) {
    const Complex p = fit.poles[m];
    const auto k = static_cast<Index>(2 * m), s = 2 * k + 2, w = s + 1;
    const double variance = out.noise.white_equivalent(p.imag() / kTwoPi);
    out.fall.push_back(-p.real() * n), out.fall_std.push_back(std::sqrt(covariance(s, s)) * n);

    DecayMode mode;
    const double to_hz = rate / kTwoPi;
    mode.frequency_hz = {std::abs(p) * to_hz, std::sqrt(out.covariance(k, k))};
    mode.damping_ratio = {damping_ratio_of(p), std::sqrt(out.covariance(k + 1, k + 1))};
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
    if (out.fall.back() > 1) {
      const double times = std::exp(factor * zeta.std / zeta.value);
      within = {zeta.value / times, zeta.value * times};
    }
    // d delta / d zeta = 2 pi / (1 - zeta^2)^(3/2)
    const double root = std::sqrt(1 - zeta.value * zeta.value);
    mode.log_decrement = {kTwoPi * zeta.value / root, kTwoPi * zeta.std / (root * root * root)};
    mode.amplitude = std::abs(fit.amplitudes[m]), mode.phase_rad = std::arg(fit.amplitudes[m]);
    mode.energy = mode_energy(fit, m);
    mode.detection = mode.energy / std::max(detection_threshold(fit.samples) * variance, 1e-300);
    mode.cycles = p.imag() / kTwoPi * n;

    Eigen::VectorXd alone = fit.mode_signal(m);
    alone += fit.residual;  // zero where samples are missing
    const double spread = (alone.array() - alone.mean()).square().sum();
    mode.r_squared = spread > 0 ? 1 - fit.residual_sum_squares / spread : 0;
    const auto cycles = cycle_amplitudes(alone, rate, p, out.noise_beside(p.imag()));
    const auto decrement = log_decrement(cycles);
    mode.damping_ratio_log_decrement = decrement.damping_ratio;
    mode.log_decrement_refusal = decrement.refusal;
    out.envelopes.push_back(envelope_of(cycles));
    mode.doubt = doubt_of(mode, alone, fit.residual, out.noise.coefficients.size());
    mode.doubtful = !mode.doubt.empty();
    mode.company = leaves_company(fit, m, out.noise_beside(p.imag()), uncertainty);
    out.modes.push_back(std::move(mode));
  }
  return out;
}

class Judgement {
 public:
  Judgement(const DescribedFit& described, const DecayBand& band, DecayResult& result)
      : d_(described), band_(band), result_(result) {}

  void run() {
    choose();
    if (refused()) return;
    for (const std::size_t m : kept_) result_.modes.push_back(d_.modes[m]);
    std::vector<Index> rows;
    for (const std::size_t m : kept_) {
      rows.push_back(static_cast<Index>(2 * m)), rows.push_back(static_cast<Index>(2 * m) + 1);
    }
    result_.covariance = d_.covariance(rows, rows);
    result_.envelope = d_.envelopes[kept_.front()];
    say();
  }

 private:
  [[nodiscard]] double hz(std::size_t m) const { return d_.modes[m].damped_frequency_hz.value; }

  /// Steady tones apart, modes outside of the band and those that grow left out.
  void choose() {
    std::vector<std::size_t> order;
    for (std::size_t m = 0; m < d_.modes.size(); ++m) {
      if (!is_offset(d_.fit.poles[m])) order.push_back(m);
    }
    std::sort(order.begin(), order.end(), [&](std::size_t l, std::size_t r) {
      return d_.modes[l].energy > d_.modes[r].energy;
    });
    const bool decays = std::ranges::any_of(order, [&](std::size_t m) { return d_.fall[m] > 0.5; });
    for (const std::size_t m : order) {
      // Hum, or known to change by less than a tenth over the record while others decay.
      if (is_tone(d_.fit.poles[m]) || (decays && std::abs(d_.fall[m]) + 2 * d_.fall_std[m] < 0.1)) {
        result_.steady_tones.push_back(d_.modes[m]);
      } else if (band_.contains(d_.fit.poles[m])) {
        const bool grows = d_.fall[m] < -0.05 && d_.fall[m] + 3 * d_.fall_std[m] < 0;
        if (grows && kept_.empty()) growing_first_ = true;
        (grows ? growing_ : kept_).push_back(m);
      }
    }
  }

  bool refused() {
    const auto refuse = [&](const char* code, std::string message) {
      result_.refuse(code, std::move(message));
      return true;
    };
    if (growing_first_) {
      const std::size_t m = growing_.front();
      return refuse(
          "no_decay",
          fmt::format("name a start and end that hold a decay, or a whole beat: the oscillation at "
                      "{:.6g} Hz grows by a factor of {:.3g} over the window",
                      hz(m), std::exp(-d_.fall[m])));
    }
    if (kept_.empty()) {
      return refuse("no_decay", result_.steady_tones.empty()
                                    ? "no oscillation in the band"
                                    : "only steady tones in the band, nothing that decays");
    }
    const std::size_t main = kept_.front();
    const DecayMode& mode = d_.modes[main];
    if (std::all_of(kept_.begin(), kept_.end(), [&](auto m) { return d_.modes[m].doubtful; })) {
      if (!mode.company || mode.r_squared < 0.3) {
        return refuse("too_noisy", "no oscillation stands out of the noise: " + mode.doubt);
      }
      return refuse("not_separable",
                    fmt::format("record for longer, or with less noise: what one decay leaves near "
                                "{:.4g} Hz is no noise: two modes that beat too slowly for this "
                                "record, or one that changes",
                                hz(main)));
    }
    if (const std::string why = driven(); !why.empty()) {
      return refuse("no_decay",
                    fmt::format("record a free decay (a tap, a release, a machine that is switched "
                                "off) or name one by start and end: the oscillation at {:.4g} Hz "
                                "does not die away by itself: {}",
                                hz(main), why));
    }
    if (!std::isfinite(mode.damping_ratio.std) || mode.cycles < 1) {
      return refuse(
          "too_noisy",
          fmt::format("record more cycles or less noise: the record holds {:.2g} cycles at "
                      "{:.3g} dB, which leave frequency and damping at {:.4g} Hz undetermined "
                      "beside offset and drift",
                      mode.cycles, result_.signal_to_noise_db, mode.frequency_hz.value));
    }
    // A mode that explains most of what is there is no noise: what it leaves has its own colour.
    if (mode.detection < kLeastDetection && mode.r_squared < 0.8) {
      return refuse(
          "too_noisy",
          fmt::format("repeat the test with a harder blow or a longer record, or give a band "
                      "around the mode: the oscillation at {:.4g} Hz has {:.2g} times the energy "
                      "that noise alone may show, and below {:.2g} times the values that are seen "
                      "are those which noise made larger",
                      mode.frequency_hz.value, mode.detection, kLeastDetection));
    }
    return false;
  }

  /// Why the strongest mode is no free decay; empty when it is one.
  std::string driven() {
    const std::size_t main = kept_.front();
    const auto& poles = d_.fit.poles;
    const double amplitude = d_.modes[main].amplitude;
    // What a random amplitude looks like to a fit: several modes within a few lines or widths.
    const auto beside = [&](std::size_t m) {
      const double width = std::max(-poles[main].real(), std::abs(poles[m].real()));
      const double lines = 4 * kTwoPi / static_cast<double>(d_.fit.samples);
      return m != main &&
             std::abs(poles[m].imag() - poles[main].imag()) < std::max(lines, 3 * width);
    };
    if (std::any_of(growing_.begin(), growing_.end(), [&](std::size_t m) {
          return beside(m) && d_.modes[m].amplitude * std::exp(-d_.fall[m]) > 0.2 * amplitude;
        })) {
      return "its amplitude grows again";
    }
    if (std::count_if(kept_.begin(), kept_.end(), beside) >= 2) {
      return "its amplitude rises and falls at random";
    }
    excitation_ = excitation(main) / amplitude;
    if (!(excitation_ > kMostExcited)) return {};
    return fmt::format(
        "what one decay leaves at its frequency goes on through the record, {:.0f} % of the "
        "amplitude at the start",
        100 * excitation_);
  }

  /// Amplitude of what goes on at mode m through the record; 0: none that noise would not show.
  [[nodiscard]] double excitation(std::size_t m) const {
    const double w = d_.fit.poles[m].imag();
    const Index n = d_.fit.samples;
    const Index block = averaging_cycle(w), count = n / block,
                terms = std::min<Index>(7, count / 4);
    if (terms < 1) return 0;
    const RunningAmplitude running(d_.fit.residual, w);
    Eigen::VectorXcd z(count);
    Eigen::MatrixXd powers(count, terms);
    for (Index k = 0; k < count; ++k) {
      z(k) = running.over(k * block, (k + 1) * block);
    }
    const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(count, -1, 1);
    for (Index p = 0; p < terms; ++p) powers.col(p) = t.pow(static_cast<double>(p));
    const Eigen::MatrixXd basis = thin_qr(powers).Q;
    const Eigen::VectorXcd left = z - basis * (basis.transpose() * z);
    const double sum = left.squaredNorm(), degrees = static_cast<double>(2 * (count - terms));
    const double expected = std::max(4 * d_.noise_beside(w) / static_cast<double>(block), 1e-300);
    // Sum of |z|^2 over half its mean is chi-squared. The density beside the mode is itself known
    // to some ten per cent only.
    const bool goes_on = 2 * sum / (1.3 * expected) > gsl_cdf_chisq_Qinv(1e-6, degrees) &&
                         sum > 4 * 0.5 * degrees * expected &&
                         left.tail(count / 2).squaredNorm() > 0.15 * sum;
    return goes_on ? std::sqrt(std::max(0.0, sum / (0.5 * degrees) - expected)) : 0;
  }

  /// Whether resonances touch: a third of a beat a time constant tells two modes from one that
  /// changes no better than what is left of one does.
  [[nodiscard]] bool overlapped(std::size_t m) const {
    const auto& poles = d_.fit.poles;
    return std::ranges::any_of(kept_, [&](std::size_t other) {
      return other != m && std::abs(poles[other].imag() - poles[m].imag()) <
                               -poles[other].real() - poles[m].real();
    });
  }

  void say() {
    const DecayMode& mode = result_.modes.front();
    const double fall = std::max(0.0, d_.fall[kept_.front()]);
    if (fall < kShortFall) {
      result_.note("record_short",
                   fmt::format("Record for longer: the amplitude falls by {:.2g} % only within the "
                               "{:.2g} cycles of the window, and the answer leans on offset and "
                               "drift",
                               100 * (1 - std::exp(-fall)), mode.cycles));
    }
    if (!(mode.damping_ratio.value > 2 * mode.damping_ratio.std)) {
      result_.note("damping_not_resolved",
                   fmt::format("damping ratio {:.3g} is not distinguishable from zero (standard "
                               "uncertainty {:.2g})",
                               mode.damping_ratio.value, mode.damping_ratio.std));
    }
    for (const DecayMode& each : result_.modes) {
      if (each.doubtful) result_.note("doubtful_mode", each.doubt);
    }
    for (const std::size_t m : kept_) {
      const DecayMode& each = d_.modes[m];
      const bool excited = m == kept_.front() && excitation_ > 0.01;
      if (!each.company && !excited && !overlapped(m)) continue;
      result_.note(
          "not_one_decay",
          fmt::format("Record for longer, or look for a change during the decay: one exponential "
                      "does not hold all that decays near {:.4g} Hz: there is a mode close by that "
                      "beats too slowly for this record, one that changes as it decays, or "
                      "excitation that goes on",
                      each.damped_frequency_hz.value));
    }
    say_whether_exponential(mode);
    for (const auto& tone : result_.steady_tones) {
      result_.note("steady_tone",
                   fmt::format("a steady tone at {:.6g} Hz (mains hum?) was fitted and kept out of "
                               "the modes",
                               tone.damped_frequency_hz.value));
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
    result_.note(
        "not_exponential",
        fmt::format("The numbers hold for one amplitude only: damping {} as the motion dies, "
                    "damping ratio {:.3g} to {:.3g} along the decay, and the frequency changes by "
                    "{:+.2g} Hz from its first part to its last",
                    envelope.law == DecayLaw::friction ? "rises (as under dry friction)"
                    : envelope.law == DecayLaw::drag   ? "falls (as under drag)"
                                                       : "stays",
                    least, most, drift.value));
  }

  const DescribedFit& d_;
  const DecayBand& band_;
  DecayResult& result_;
  std::vector<std::size_t> kept_, growing_;
  bool growing_first_ = false;
  double excitation_ = 0;  // over the amplitude at the start
};

}  // namespace

void judge_decay(const DampedSinusoidsFit& fit, const DecayBand& band, double sample_rate_hz,
                 DecayResult& result) {
  const DescribedFit described = describe_fit(fit, sample_rate_hz);
  result.offset = fit.offset;
  result.drift_per_s = fit.drift / static_cast<double>(fit.samples) * sample_rate_hz;
  result.noise_std = std::sqrt(described.noise.variance);
  result.degrees_of_freedom = fit.degrees;
  result.coverage_factor_95 = gsl_cdf_tdist_Pinv(0.975, static_cast<double>(fit.degrees));
  result.residual = fit.residual;
  const double amplitude = described.modes[strongest_mode(fit, band)].amplitude;
  result.signal_to_noise_db =
      10 * std::log10(0.5 * amplitude * amplitude / std::max(described.noise.variance, 1e-300));
  Judgement(described, band, result).run();
}

}  // namespace rigfit::signal
