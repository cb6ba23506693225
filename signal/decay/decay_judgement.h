// Which modes of a fit are given, whether a decay is refused, and what a person should know before
// using its numbers. There are five reasons:
//
//   refused  no_decay        grows, keeps its amplitude, is driven, or nothing is in the band
//            too_noisy       noise could look like it, or its frequency is hardly determined
//   said     not_one_decay   what is left at a mode is no noise: a neighbour, a change, excitation
//            not_exponential damping or frequency change along the decay
//            damping_not_resolved
//
// A random amplitude, of a mode that is driven, looks to a fit like several modes within a few
// lines or widths, some of which grow.
#pragma once

#include "signal/decay/decay_result.h"
#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {

/// Fills modes, steady tones, noise and envelope of `result`, or its refusal. `fit` must not
/// be rank-deficient.
void judge_decay(const DampedSinusoidsFit& fit, const DecayBand& band, double sample_rate_hz,
                 DecayResult& result);

}  // namespace rigfit::signal
