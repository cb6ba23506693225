// Error bars of FRFs that another analyser averaged, from their coherence.
//
//   std(Re H) = std(Im H) = |H| sqrt((1 - g2) / (2 (n - 1) g2)),   n averages
// (Bendat and Piersol, Random Data, 4th ed., sec. 9.2, with n - 1 in place of n as in frf.h).
// Coherence of few averages scatters from line to line: the noise power |H|^2 (1 - g2) / g2 is
// averaged over lines before it becomes an error bar.
#pragma once

#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// Fills `H_std` of a set that has a coherence and no error bars. `averages`: stated by a person,
/// 0: take the set's own. Notes, added to the set's: "assumed" (two are taken, which gives the
/// largest error bars), "coherence_unusable" (one average, values outside 0..1), "low_coherence"
/// (median in the band below 0.8). A set without a coherence or with error bars is left as it is.
void error_bars_from_coherence(FrfSet& frfs, int averages,
                               const std::optional<std::pair<double, double>>& band_hz);

}  // namespace rigfit::signal
