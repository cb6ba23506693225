// Turns a fit of damped sinusoids into modes with uncertainties. Frequency and damping come with
// the fit's propagated covariance, intervals from the likelihood (pole_interval.h). Steady tones
// are listed apart; the log decrement and the envelope are added.
#pragma once

#include "signal/decay/decay_result.h"
#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {

/// How the samples of a fit were taken.
struct DecaySampling {
  double rate_hz = 0;
  double shift = 0;  ///< that frequencies were lowered by, cycles per sample (narrow_record.h)
};

/// Fills `result` from the fit to `samples`; refuses where nothing in the band decays.
void describe_decay(DecayResult& result, const DecaySamples& samples, const DampedSinusoidsFit& fit,
                    const DecayBand& band, const DecaySampling& sampling,
                    const DecayOptions& options);

}  // namespace rigfit::signal
