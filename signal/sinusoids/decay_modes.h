// Finds the damped sinusoids in a stretch of samples: the strongest first, then one more as long as
// the residual has a peak that noise of its colour does not explain.
//
// A mode is taken when the energy that it explains exceeds what the best of all cells of the search
// takes out of noise with the chance kFalseAlarm, when its pole is determined by the samples, and
// when it does not merely correct another mode that departs from an exponential.
// A mode that noise of the residual's colour could imitate, as large as it is while the mode lasts
// (residual_noise.h), is removed at the end, unless it is the only one.
//
// The search is a bank of matched filters over frequency and decay rate. For a decay rate a the
// filter's output at frequency w is |sum_j y_j exp(-(a + i w) j)|^2, one FFT applied to the record
// under the window exp(-a j). Divided by half the window's energy it is the energy that a sinusoid
// of that pole takes out of the record, and for white noise of variance s^2 it has a mean of 2 s^2
// (chi-squared, two degrees). The median of the undamped spectrum around a peak is the noise there,
// so that coloured noise is not taken for modes.
#pragma once

#include "signal/sinusoids/damped_sinusoids.h"

namespace rigfit::signal {

/// Chance that noise alone adds a mode.
inline constexpr double kFalseAlarm = 1e-4;

struct DecaySearchOptions {
  double lowest = 0;             ///< cycles per sample; lower peaks are ignored
  double highest = 0.5;          ///< cycles per sample
  int candidates = 3;            ///< largest number of distinct peaks, best first
  double energy_over_noise = 0;  ///< peaks with less are left out; see `detection_threshold`
};

struct DecayCandidate {
  Complex pole;               ///< per sample
  double energy = 0;          ///< taken out of the record's sum of squares
  double noise_variance = 0;  ///< white-equivalent, near that frequency
};

/// The undamped filter's output at all frequencies.
struct LineSpectrum {
  VectorXd power;              ///< 2 |F|^2 / N
  double lines_per_cycle = 0;  ///< lines of `power` per frequency of one cycle per sample
  Index samples = 0;           ///< N
  double total = 0;            ///< sum of squares of the samples
};
[[nodiscard]] LineSpectrum line_spectrum(const Ref<const VectorXd>& y);

/// White-equivalent variance of a sample beside a pole.
[[nodiscard]] double noise_near(const LineSpectrum& spectrum, Complex pole);

/// The strongest distinct peaks of the bank, by energy. `y` should have its offset and trend
/// removed.
[[nodiscard]] std::vector<DecayCandidate> search_decays(const Ref<const VectorXd>& y,
                                                        const DecaySearchOptions& options = {});

/// Energy over noise that the best of all cells of the bank exceeds in noise alone with probability
/// `false_alarm`.
[[nodiscard]] double detection_threshold(Index samples, double false_alarm = kFalseAlarm);

/// `y` less its least-squares line; missing samples (NaN) are left out and set to 0.
[[nodiscard]] VectorXd without_trend(const Ref<const VectorXd>& y);

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
                                        std::span<const std::size_t> modes);
/// The mode with the largest energy in the band.
[[nodiscard]] std::size_t strongest_mode(const DampedSinusoidsFit& fit, const DecayBand& band);
/// -Re p / |p|.
[[nodiscard]] double damping_ratio_of(Complex pole);

}  // namespace rigfit::signal
