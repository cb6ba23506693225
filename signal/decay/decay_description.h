// Turns a fit of damped sinusoids into modes with uncertainties. Frequency and damping come with
// the fit's propagated covariance. Steady tones
// are listed apart; the log decrement and the envelope are added.
#pragma once

#include "signal/decay/decay_result.h"
#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {

/// Fills `result` from the fit to `samples`; refuses where nothing in the band decays.
void describe_decay(DecayResult& result, const DampedSinusoidsFit& fit, const DecayBand& band,
                    double rate_hz, const DecayOptions& options);

}  // namespace rigfit::signal
