// From a fit of damped sinusoids to modes with uncertainties: frequency and damping by propagation
// of the fit's covariance, intervals by the likelihood (pole_interval.h), steady tones apart, the
// log decrement and the envelope beside them.
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
