#include "signal/decay/decay_judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "signal/decay/decay_excitation.h"
#include "signal/numerics/numbers.h"
#include "signal/sinusoids/decay_search.h"

namespace rigfit::signal {
namespace {

using Eigen::Index;

// Energy over the noise's variance from which linear intervals cover 90 % and more: an error of a
// fifth in the damping.
constexpr double kLeastEnergy = 100;
// Relative standard uncertainty of a frequency that says nothing any more.
constexpr double kWidestFrequency = 0.25;
// A vibration over more cycles that changes by less than a tenth is steady, unless its damping is
// seen: above that of any structure that is left alone.
constexpr double kManyCycles = 20, kLeastFall = 0.1, kLeastDamping = 1e-5;

struct Evidence {
  const DecayResult& result;
  const DampedSinusoidsFit& fit;
  std::size_t main = 0;  ///< of the fit: the strongest mode given, or the strongest of all
  double seconds = 0;
  Excitation excitation;  ///< at the strongest mode
  bool beside = false;    ///< its line has another beside it that noise would not show
  bool cluster = false;   ///< several modes within its line, as a random amplitude gives

  [[nodiscard]] const DecayMode& mode() const { return result.modes.front(); }
  [[nodiscard]] double frequency() const {
    return fit.poles[main].imag() / kTwoPi * static_cast<double>(fit.samples) / seconds;
  }
  [[nodiscard]] double energy() const {
    return fit.energy[main] / std::max(fit.noise[main], 1e-300);
  }
  [[nodiscard]] double fall() const {
    return -fit.poles[main].real() * static_cast<double>(fit.samples);
  }
};

struct Reason {
  const char* code;
  std::function<bool(const Evidence&)> applies;
  std::function<std::string(const Evidence&)> message;
};

bool is_steady(const DecayMode& mode) {
  const auto& zeta = mode.damping_ratio;
  const double per_ratio = kTwoPi * mode.cycles;  // time constants in the window
  return mode.cycles > kManyCycles && per_ratio * (zeta.value + 2 * zeta.std) < kLeastFall &&
         (zeta.value < 2 * zeta.std || zeta.value < kLeastDamping);
}

/// In this order; the first that applies refuses.
const std::vector<Reason>& reasons() {
  static const std::vector<Reason> table{
      {"nothing_decays", [](const Evidence& e) { return e.result.modes.empty(); },
       [](const Evidence& e) {
         return e.fall() < 0
                    ? fmt::format(
                          "the oscillation at {:.6g} Hz grows by a factor of {:.3g} over "
                          "the window: name a start and end that hold a decay",
                          e.frequency(), std::exp(-e.fall()))
                    : std::string("nothing in the band decays: name another band or stretch");
       }},
      {"too_noisy", [](const Evidence& e) { return e.energy() < kLeastEnergy; },
       [](const Evidence& e) {
         return fmt::format(
             "the oscillation at {:.4g} Hz has {:.0f} times the energy of the noise "
             "in one sample, less than {:.0f}: repeat the test, or name its band",
             e.frequency(), e.energy(), kLeastEnergy);
       }},
      {"not_determined",
       [](const Evidence& e) {
         const auto& m = e.mode();
         return !(m.frequency_hz.std < kWidestFrequency * m.frequency_hz.value) ||
                !std::isfinite(m.damping_ratio.std) || m.cycles < 1;
       },
       [](const Evidence& e) {
         return fmt::format(
             "the window holds {:.2g} cycles of {:.4g} Hz at {:.3g} dB, which leave "
             "its frequency uncertain by {:.0f} %: record longer",
             e.mode().cycles, e.mode().frequency_hz.value, e.result.signal_to_noise_db,
             100 * e.mode().frequency_hz.std / e.mode().frequency_hz.value);
       }},
      {"driven",
       [](const Evidence& e) {
         return e.cluster ||
                (e.excitation.goes_on() && e.excitation.amplitude > 0.1 * e.mode().amplitude);
       },
       [](const Evidence& e) {
         return fmt::format(
             "the oscillation at {:.4g} Hz does not die away by itself: {}. Name a stretch where "
             "nothing drives it, or tap, release or switch off harder",
             e.frequency(),
             e.cluster ? "its amplitude rises and falls at random"
                       : fmt::format("what one decay leaves goes on through the record, {:.0f} % "
                                     "of the amplitude at the start",
                                     100 * e.excitation.amplitude / e.mode().amplitude));
       }},
      {"nothing_decays",
       [](const Evidence& e) {
         return std::all_of(e.result.modes.begin(), e.result.modes.end(), is_steady);
       },
       [](const Evidence& e) {
         return fmt::format(
             "the vibration at {:.6g} Hz is steady over {:.0f} cycles: something "
             "drives it; name a stretch in which it decays",
             e.frequency(), e.mode().cycles);
       }}};
  return table;
}

/// Whether what a damped sinusoid leaves has a line beside it that noise would not show.
bool leaves_line(const DampedSinusoidsFit& fit, std::size_t m, double false_alarm) {
  const double f = fit.poles[m].imag() / kTwoPi;
  const double reach = 2 / static_cast<double>(fit.samples) - fit.poles[m].real() / kTwoPi * 2;
  DecaySearchOptions beside;
  beside.damped = false, beside.candidates = 1;
  beside.band_low = fit.low, beside.band_high = fit.high;
  beside.lowest = std::max(0.0, f - reach), beside.highest = std::min(0.5, f + reach);
  beside.energy_over_noise = detection_threshold(fit.samples, false_alarm);
  return !search_lines(line_spectrum(fit.residual), beside).empty();
}

void say(DecayResult& result, const Evidence& e) {
  const DecayMode& mode = result.modes.front();
  const double zeta = mode.damping_ratio.value;
  if (e.fall() < 0.7) {
    note(result, "record_shorter_than_decay",
         fmt::format("Record longer for the damping: the amplitude falls by {:.2g} % only within "
                     "the {:.4g} s of the window",
                     100 * (1 - std::exp(-std::max(e.fall(), 0.0))), e.seconds));
  }
  if (!(zeta > 2 * mode.damping_ratio.std)) {
    note(result, "damping_not_resolved",
         fmt::format("Do not use the damping ratio: {:.3g} is not distinguishable from zero "
                     "(standard uncertainty {:.2g})",
                     zeta, mode.damping_ratio.std));
  }
  if (e.beside) {
    note(result, "not_one_decay",
         fmt::format("Record longer or strike elsewhere: what the fit leaves near {:.4g} Hz is no "
                     "noise, but a mode close by or one that changes as it decays",
                     mode.damped_frequency_hz.value));
  }
  if (e.excitation.goes_on() && e.excitation.amplitude > 0.01 * mode.amplitude) {
    note(
        result, "excited",
        fmt::format("Take away what drives the mode at {:.4g} Hz while it decays: {:.2g} % of the "
                    "amplitude at the start; the intervals allow for it",
                    mode.damped_frequency_hz.value, 100 * e.excitation.amplitude / mode.amplitude));
  }
  const auto& envelope = result.envelope;
  if (envelope.law != DecayLaw::exponential) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const auto& p : envelope.points) {
      least = std::min(least, p.damping_ratio.value), most = std::max(most, p.damping_ratio.value);
    }
    note(result, "not_exponential",
         fmt::format("Use the damping of the amplitude in question: it {}, {:.3g} to {:.3g} along "
                     "the decay",
                     envelope.law == DecayLaw::friction
                         ? "rises as the motion dies, as under dry friction"
                         : "falls as the motion dies, as under drag",
                     least, most));
  }
  const auto& drift = envelope.frequency_drift_hz;
  if (std::isfinite(drift.std) && std::abs(drift.value) > 5 * drift.std &&
      std::abs(drift.value) > 2 * mode.frequency_hz.std) {
    note(result, "frequency_drifts",
         fmt::format("frequency changes by {:+.4g} Hz from the first to the last part of the decay",
                     drift.value));
  }
  if (result.offset_decays_s > 0) {
    note(result, "offset_decays",
         fmt::format("an offset that decays with a time constant of {:.3g} s was fitted beside the "
                     "modes",
                     result.offset_decays_s));
  }
  for (const auto& tone : result.steady_tones) {
    note(result, "steady_tone",
         fmt::format("a steady tone at {:.6g} Hz (mains hum?) was fitted and kept "
                     "out of the modes",
                     tone.damped_frequency_hz.value));
  }
}

}  // namespace

void refuse(DecayResult& result, std::string code, std::string message) {
  result.refusal_code = std::move(code);
  result.refusal = std::move(message);
}

void note(DecayResult& result, std::string code, std::string message) {
  result.notes.push_back({std::move(code), std::move(message), ""});
}

void judge_decay(DecayResult& result, const DampedSinusoidsFit& fit, double sample_rate_hz,
                 double false_alarm) {
  Evidence e{result, fit, 0, static_cast<double>(fit.samples) / sample_rate_hz, {}, false, false};
  double most = -1;
  for (std::size_t m = 0; m < fit.poles.size(); ++m) {
    const bool given =
        !result.modes.empty() && std::abs(fit.amplitudes[m]) == result.modes.front().amplitude;
    const double energy = given ? std::numeric_limits<double>::infinity() : fit.energy[m];
    if (energy > most) most = energy, e.main = m;
  }
  if (!result.modes.empty()) {
    e.excitation = excitation_at(fit.residual, fit.poles[e.main].imag());
    e.beside = leaves_line(fit, e.main, false_alarm);
    const double lines = 4 * kTwoPi / static_cast<double>(fit.samples);
    const auto near = std::count_if(fit.poles.begin(), fit.poles.end(), [&](auto pole) {
      const double width = std::max(-fit.poles[e.main].real(), std::abs(pole.real()));
      return std::abs(fit.poles[e.main].imag() - pole.imag()) < std::max(lines, 3 * width);
    });
    e.cluster = near > 2;
  }
  for (const Reason& reason : reasons()) {
    if (!reason.applies(e)) continue;
    refuse(result, reason.code, reason.message(e));
    result.steady_tones.clear();
    return;
  }
  say(result, e);
}

}  // namespace rigfit::signal
