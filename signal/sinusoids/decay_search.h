// Where in a record damped sinusoids are: a bank of matched filters over frequency and decay rate.
//
// For a decay rate a the filter's output at frequency w is |sum_j y_j exp(-(a + i w) j)|^2, one FFT
// of the record under the window exp(-a j). Divided by half the window's energy it is the energy
// that a sinusoid of that pole takes out of the record, and for white noise of variance s^2 it has
// a mean of 2 s^2 (chi-squared, two degrees). The noise is read beside each peak, as the median
// of the undamped spectrum around it, so that coloured noise does not pass for modes.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <span>
#include <vector>

#include "signal/sinusoids/damped_sinusoids.h"

namespace rigfit::signal {

struct DecaySearchOptions {
  double lowest = 0;                     ///< cycles per sample; peaks below are not looked at
  double highest = 0.5;                  ///< cycles per sample
  double band_low = 0, band_high = 0.5;  ///< that the samples hold; beside it there is no noise
  int candidates = 3;                    ///< at most so many distinct peaks, best first
  bool damped = true;                    ///< false: the undamped filter only
  double energy_over_noise = 0;  ///< peaks with less are left out; see `detection_threshold`
};

struct DecayCandidate {
  std::complex<double> pole;  ///< per sample
  double energy = 0;          ///< taken out of the record's sum of squares
  double noise_variance = 0;  ///< white-equivalent, near that frequency
};

/// The undamped filter's output at all frequencies.
struct LineSpectrum {
  Eigen::VectorXd power;       ///< 2 |F|^2 / N
  double lines_per_cycle = 0;  ///< of `power` in a frequency of one cycle per sample
  Eigen::Index samples = 0;    ///< N
  double total = 0;            ///< sum of squares of the samples
};
[[nodiscard]] LineSpectrum line_spectrum(const Eigen::Ref<const Eigen::VectorXd>& y);

/// Strongest distinct peaks of the bank, by energy. `y` should have its offset and trend removed.
[[nodiscard]] std::vector<DecayCandidate> search_decays(const Eigen::Ref<const Eigen::VectorXd>& y,
                                                        const DecaySearchOptions& options = {});
/// Those of the undamped filter alone.
[[nodiscard]] std::vector<DecayCandidate> search_lines(const LineSpectrum& spectrum,
                                                       const DecaySearchOptions& options = {});

/// Starts for a pole near `candidate` that lives for a few cycles only, where the two halves of the
/// spectrum and the background overlap and the bank misleads: the fit's own functional (offset and
/// drift included) on a grid of frequencies and decay rates, best first. Empty when `candidate`
/// lives for many cycles.
[[nodiscard]] std::vector<DecayCandidate> few_cycle_starts(
    const Eigen::Ref<const Eigen::VectorXd>& y, const DecayCandidate& candidate,
    const DecaySearchOptions& options = {});

/// Variance of white noise of the density beside what a fit leaves at frequency `f`, cycles per
/// sample; at the mode itself more than noise may be left.
[[nodiscard]] double noise_beside(const DampedSinusoidsFit& fit, double f);

/// Energy over noise that the best of all cells of the bank exceeds in noise alone with probability
/// `false_alarm`.
[[nodiscard]] double detection_threshold(Eigen::Index samples, double false_alarm);

/// The straight line of least squares taken off, missing samples (NaN) left out and set to 0.
[[nodiscard]] Eigen::VectorXd without_trend(const Eigen::Ref<const Eigen::VectorXd>& y);

}  // namespace rigfit::signal
