// From a fit of damped sinusoids to modes with uncertainties: frequency and damping by propagation
// of the fit's covariance, steady tones apart, the log decrement and the envelope beside them.
#pragma once

#include "signal/decay/decay_result.h"
#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {

/// Fills `result` from a fit; no modes where nothing in the band is seen to decay.
void describe_decay(DecayResult& result, const DampedSinusoidsFit& fit, const DecayBand& band,
                    double sample_rate_hz, const EnvelopeOptions& options);

}  // namespace rigfit::signal
