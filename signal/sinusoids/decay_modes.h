// Finds the damped sinusoids in a stretch of samples: the strongest first, then one more as long as
// the residual has a peak that noise of its colour does not explain.
//
// A mode is taken when the energy that it explains exceeds what the best of all cells of the search
// (decay_search.h) takes out of noise with the chance kFalseAlarm, when its pole is determined by
// the samples, and when it does not merely correct another mode that departs from an exponential.
// A mode that noise of the residual's colour could imitate, as large as it is while the mode lasts
// (residual_noise.h), is removed at the end, unless it is the only one.
#pragma once

#include "signal/sinusoids/damped_sinusoids.h"
#include "signal/sinusoids/decay_search.h"

namespace rigfit::signal {

struct DecaySamples {
  VectorXd values;  ///< 0 where missing
  std::vector<Index> missing;
  std::vector<KnownTone> known;  ///< of samples beside these; their poles stand first in fits
};

/// Samples [start, end) of `y`, NaN where missing.
[[nodiscard]] DecaySamples decay_samples(const Ref<const VectorXd>& y, Index start, Index end);

struct DecayBand {
  double low, high;  ///< undamped natural frequency, cycles per sample
  bool all;          ///< no limits
  /// Whether a mode in the band, neither a steady tone nor an offset.
  [[nodiscard]] bool contains(Complex pole) const;
};

/// Most modes in a band, and outside it.
inline constexpr int kMostModes = 12;

/// All modes that the samples support; nothing when there is none. `known` poles, modes or not,
/// are where the search starts; steady tones and offsets among them stay.
[[nodiscard]] std::optional<DampedSinusoidsFit> find_decay_modes(
    const DecaySamples& samples, const DecayBand& band, const std::vector<Complex>& known = {},
    int max_modes = kMostModes);

/// The fit of these poles; nothing where they cannot be told apart.
[[nodiscard]] std::optional<DampedSinusoidsFit> fit_poles(const DecaySamples& samples,
                                                          const std::vector<Complex>& poles);

/// Energy of mode `m` over the samples, sum of squares.
[[nodiscard]] double mode_energy(const DampedSinusoidsFit& fit, std::size_t m);
/// Sum of squares left when the complex amplitudes of `modes` may also vary with t^2 and t^3, which
/// takes as many parameters per mode as one more mode.
[[nodiscard]] double departing_residual(const DampedSinusoidsFit& fit,
                                        std::span<const Index> missing,
                                        std::span<const std::size_t> modes);
/// The mode with the largest energy in the band.
[[nodiscard]] std::size_t strongest_mode(const DampedSinusoidsFit& fit, const DecayBand& band);
/// -Re p / |p|.
[[nodiscard]] double damping_ratio_of(Complex pole);

}  // namespace rigfit::signal
