// Steps of the estimate of a decay, in the order in which decay_estimation.cc takes them.
#pragma once

#include "signal/decay/decay.h"

namespace rigfit::signal {

/// Number of samples without a run of equal values at the end of the record (a stopped logger
/// writes zeros); such a run has 16 samples or more and does not end a swing that comes to rest on
/// a coarse scale: the 16 samples before it were not all within two steps of it.
[[nodiscard]] Index recorded_until(const Ref<const VectorXd>& y);

// A record brought down to the rate that the modes of a band need.
//
// Where a band is asked for, what lies far above it only hides its modes and costs time. The record
// is filtered and every `step`-th sample is kept; the decay is then fitted there:
//   x_i = sum_k h_k y_(first + i step + k),   |k| < 4.3 step
// with h a sinc that cuts off at half the rate of x under Kaiser's window of 100 dB: what lies
// below 1/8 of that rate is unchanged, what lies above 7/8, and would be folded to there, is gone.
// Poles and amplitudes are those of the record, and so are their Cramer-Rao bounds, as noise
// outside of the band holds nothing of the modes. Source: Harris, Multirate Signal Processing
// (2004), ch. 3.

struct NarrowRecord {
  VectorXd samples;
  Index first = 0, step = 1;  ///< samples[i] is that of record sample first + i step
  double noise_gain = 1;      ///< on the std of white noise

  [[nodiscard]] Index record_sample(Index sample) const { return first + sample * step; }
};

/// `y` in `band`. Nothing where every sample is needed, or where there are gaps or rails.
[[nodiscard]] std::optional<NarrowRecord> narrow_record(const Ref<const VectorXd>& y,
                                                        const DecayBand& band);

// What a record holds beside the modes of a decay, as poles of the same fit (damped_sinusoids.h):
// tones that do not decay (mains hum, a machine) and an offset that dies away (an amplifier's
// high-pass after the tap, a hand let go).
//
// A tone within a line's width of a mode cannot be told from it while the mode lasts, but it can
// before the impact and behind the decay: there tones are looked for, and what the samples before
// the impact say of them counts in the fit.
//
// Clipped samples of a decay seen from its fit: a fit to all other samples goes beyond the rail
// where they are.
//
// The samples at the record's extremes are left out, the rest is fitted, and the fit is compared
// there. In an unclipped record the extremes are its luckiest samples and the fit lies inside them.
// In a clipped record the fit lies outside, by more than the noise:
//   sum_j max(0, fit_j - rail)^2 / s^2 > chi-squared of as many degrees, 1e-4.

/// Tones of the record `y` (NaN where missing), from its first `quiet` samples, which lie before
/// the impact, or from those of [start, end) behind the modes of `fit`, the longer of both.
/// Amplitudes are those at `start`; without information where they come from [start, end), to which
/// `fit` was made.
[[nodiscard]] std::vector<KnownTone> steady_tones(const Ref<const VectorXd>& y, Index quiet,
                                                  Index start, Index end,
                                                  const DampedSinusoidsFit& fit);

/// `fit` to `samples` with a decaying offset as its last pole, where that explains more than noise
/// of the residual's colour would with the chance kFalseAlarm.
[[nodiscard]] std::optional<DampedSinusoidsFit> with_offset(const DecaySamples& samples,
                                                            const DampedSinusoidsFit& fit);

/// The samples on a rail, which say nothing of the decay but that it went there.
[[nodiscard]] std::vector<Index> clipped_by_fit(const DecaySamples& samples, const DecayBand& band);

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

/// Fills modes, steady tones, noise and envelope of `result`, or its refusal. `fit` must not
/// be rank-deficient.
void judge_decay(const DampedSinusoidsFit& fit, const DecayBand& band, double sample_rate_hz,
                 DecayResult& result);

}  // namespace rigfit::signal
