#include "signal/decay/decay_judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "signal/numerics/numbers.h"

namespace rigfit::signal {
namespace {

// Relative standard uncertainty of a frequency that says nothing any more. So wide that records are
// refused for their noise first: to refuse by an estimate's own uncertainty, which grows with the
// damping found, would leave those whose damping came out too small.
constexpr double kWidestFrequency = 0.25;
// Energy over the largest that noise shows with probability `false_alarm`: at 2.5 times the
// detection itself shifts the root of the energy by under 1 % of its standard uncertainty.
constexpr double kLeastDetection = 2.5;

}  // namespace

void refuse(DecayResult& result, std::string code, std::string message) {
  result.refusal_code = std::move(code);
  result.refusal = std::move(message);
}

void note(DecayResult& result, std::string code, std::string message) {
  result.notes.push_back({std::move(code), std::move(message), ""});
}

void judge_decay(DecayResult& result, double sample_rate_hz) {
  const DecayMode& mode = result.modes.front();
  const double f = mode.frequency_hz.value, zeta = mode.damping_ratio.value;
  const double seconds = static_cast<double>(result.end - result.start) / sample_rate_hz;
  if (!(mode.frequency_hz.std < kWidestFrequency * f) || !std::isfinite(mode.damping_ratio.std)) {
    refuse(result, "not_determined",
           fmt::format(
               "frequency ({:.4g} Hz) is uncertain by more than {:.0f} %: the record holds {:.2g} "
               "cycles at {:.3g} dB; more cycles or less noise are needed",
               f, 100 * kWidestFrequency, mode.cycles, result.signal_to_noise_db));
    return;
  }
  if (mode.detection < kLeastDetection) {
    refuse(result, "too_noisy",
           fmt::format("repeat the test with a harder blow or a longer record, or give a band "
                       "around the mode: the oscillation at {:.4g} Hz has {:.2g} times the energy "
                       "that noise alone may show, and below {:.2g} times the values that are seen "
                       "are those which noise made larger",
                       f, mode.detection, kLeastDetection));
    return;
  }
  if (mode.cycles < 1) {
    refuse(result, "under_one_cycle",
           fmt::format(
               "the window holds {:.2g} cycles: offset, drift and damping cannot be told apart "
               "below one",
               mode.cycles));
    return;
  }
  const double fall = zeta * kTwoPi * f * seconds;
  if (fall < 0.7) {
    note(result, "record_shorter_than_decay",
         fmt::format(
             "the amplitude falls by {:.2g} % only within the {:.4g} s of the window: a longer "
             "record would determine the damping better",
             100 * (1 - std::exp(-std::max(fall, 0.0))), seconds));
  }
  if (!(zeta > 2 * mode.damping_ratio.std)) {
    note(result, "damping_not_resolved",
         fmt::format(
             "damping ratio {:.3g} is not distinguishable from zero (standard uncertainty {:.2g})",
             zeta, mode.damping_ratio.std));
  } else if (mode.damping_ratio.std > 0.1 * zeta) {
    note(result, "damping_uncertain",
         fmt::format("damping ratio is known to {:.0f} % only: too noisy or too short",
                     100 * mode.damping_ratio.std / zeta));
  }
  for (const DecayMode& each : result.modes) {
    if (each.doubtful) note(result, "doubtful_mode", each.doubt);
  }
  for (const DecayMode& each : result.modes) {
    if (!each.company) continue;
    note(result, "not_one_decay",
         fmt::format(
             "Record for longer, or look for a change during the decay: the residual near {:.4g} "
             "Hz is not noise but a mode close by that beats too slowly for this record, or one "
             "that changes as it decays",
             each.damped_frequency_hz.value));
  }
  if (mode.cycles < 3) {
    note(result, "few_cycles",
         fmt::format("{:.2g} cycles only: the answer leans on the model of offset "
                     "and drift",
                     mode.cycles));
  }
  const auto& envelope = result.envelope;
  if (envelope.law != DecayLaw::exponential) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const auto& p : envelope.points) {
      least = std::min(least, p.damping_ratio.value), most = std::max(most, p.damping_ratio.value);
    }
    note(result, "not_exponential",
         fmt::format(
             "damping depends on amplitude ({}): damping ratio {:.3g} to {:.3g} along the decay; "
             "one number holds for one amplitude only",
             envelope.law == DecayLaw::friction ? "rises as the motion dies, as under dry friction"
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
  if (result.residual_order > 0) {
    note(result, "coloured_residual",
         fmt::format(
             "the residual is not white (autoregression of order {}): uncertainties allow for it",
             result.residual_order));
  }
  for (const auto& tone : result.steady_tones) {
    note(result, "steady_tone",
         fmt::format("a steady tone at {:.6g} Hz (mains hum?) was fitted and kept "
                     "out of the modes",
                     tone.damped_frequency_hz.value));
  }
}

}  // namespace rigfit::signal
