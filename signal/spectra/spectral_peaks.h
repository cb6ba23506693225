// Resonances of a structure under unmeasured excitation (wind, traffic, a pluck): frequency of each
// peak with its uncertainty, and half-power bandwidth.
//
// Peaks are found in Welch's averaged spectrum, where they exceed the local floor by what noise
// alone would show once in a hundred records. Each is then fitted in the periodogram P(f) of the
// whole record by Whittle's likelihood
//
//   -ln L = sum_lines ln S(f) + P(f) / S(f),   S(f) = A (B/2)^2 / ((f - f0)^2 + (B/2)^2) + C
//
// whose information gives the uncertainties: for a resonance driven by white noise var f0 = B / (4
// pi T), the Cramer-Rao bound, T the record's length. Each is fitted in eight parts of the record
// too: where their frequencies scatter by more than their uncertainties (wind, traffic and
// temperature change a cable), value and uncertainty are those of groups that differ (groups.h).
// Tones of constant amplitude (mains hum, a machine) are taken out first and listed apart
// (steady_tones.h); a line as steady as a tone that may be a resonance of little damping stays a
// peak with a mark. Sources: Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70; Whittle, Ark.
// Mat. 2 (1953) 423.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "signal/numerics/estimate.h"
#include "signal/spectra/steady_tones.h"

namespace rigfit::signal {

struct SpectralPeakOptions {
  double low_hz = 0, high_hz = 0;  ///< band; high 0: to the end
  int max_peaks = 12;              ///< only the strongest are kept
};

struct SpectralPeak {
  Estimate frequency_hz;
  double bandwidth_hz = 0;     ///< half-power bandwidth
  double signal_to_noise = 0;  ///< power at the peak over the floor beside it
  /// Std of the frequency between parts of the record, beyond their uncertainty; 0: they agree.
  double between_parts_hz = 0;
  bool tone = false;       ///< as narrow as the record can resolve
  bool undecided = false;  ///< may be a tone or a lightly damped resonance
};

struct SpectralPeaks {
  std::vector<SpectralPeak> peaks;         ///< by rising frequency
  std::vector<SteadyTone> tones;           ///< by rising frequency; not among the peaks
  Eigen::VectorXd frequency_hz, spectrum;  ///< Welch's, one-sided, unit^2/Hz, without the tones
  std::string reason;                      ///< why there is no peak
};

/// `samples`: finite, uniform. Throws std::invalid_argument for fewer than 256 samples, a sample
/// that is not finite, or a band without any line.
[[nodiscard]] SpectralPeaks spectral_peaks(const Eigen::Ref<const Eigen::VectorXd>& samples,
                                           double sample_rate_hz,
                                           const SpectralPeakOptions& options = {});

}  // namespace rigfit::signal
