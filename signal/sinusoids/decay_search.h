// Searches a record for damped sinusoids by a bank of matched filters over frequency and decay
// rate.
//
// For a decay rate a the filter's output at frequency w is |sum_j y_j exp(-(a + i w) j)|^2, one FFT
// applied to the record under the window exp(-a j). Divided by half the window's energy it is the
// energy that a sinusoid of that pole takes out of the record, and for white noise of variance s^2
// it has a mean of 2 s^2 (chi-squared, two degrees). The median of the undamped spectrum around
// a peak is the noise there, so that coloured noise is not taken for modes.
#pragma once

#include "signal/numerics/numbers.h"

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

}  // namespace rigfit::signal
