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
#pragma once

#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {

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

}  // namespace rigfit::signal
