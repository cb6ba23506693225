// Which modes of a fit are given, whether a decay is refused, and what a person should know before
// using its numbers. There are eight reasons:
//
//   refused  no_decay        grows, keeps its amplitude, is driven, or nothing is in the band
//            not_separable   two modes that beat too slowly for the record, or one that changes
//            too_noisy       noise could look like it, or its frequency is hardly determined
//   said     doubtful_mode   noise of the residual's colour could look like one of the modes
//            not_one_decay   what is left at a mode is no noise: a neighbour, a change, excitation
//            not_exponential damping or frequency change along the decay
//            record_short    the record shows less than half a time constant or three cycles
//            damping_not_resolved
//
// Driven or free: what a fit leaves at a mode's frequency, as complex amplitudes z_k over blocks,
// is of noise alone white with E|z|^2 = 4 s^2 / block. A mode that changes as it decays leaves
// something smooth: a polynomial of the sixth degree in time is taken out. Excitation leaves a
// random walk, which is neither, over the whole of the record.
#pragma once

#include "signal/decay/decay_result.h"
#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {

/// Fills modes, steady tones, covariance and envelope of `result`, or its refusal. `fit` must not
/// be rank-deficient.
void judge_decay(const DampedSinusoidsFit& fit, const DecayBand& band, double sample_rate_hz,
                 DecayResult& result);

}  // namespace rigfit::signal
