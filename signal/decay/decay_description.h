// From a fit of damped sinusoids to modes with uncertainties: frequency and damping by propagation
// of the fit's covariance, intervals by the likelihood (pole_interval.h), steady tones apart, the
// log decrement and the envelope beside them.
#pragma once

#include "signal/decay/decay.h"
#include "signal/decay/decay_modes.h"

namespace rigfit::signal {

/// Fills `result` from the fit to `samples`; refuses where nothing in the band decays.
void describe_decay(DecayResult& result, const DecaySamples& samples, const DampedSinusoidsFit& fit,
                    const DecayBand& band, double sample_rate_hz, const DecayOptions& options);

}  // namespace rigfit::signal
