// What the change from hit to hit makes of poles that were fitted to the average of the hits.
//
// The difference of a hit's FRFs from the average goes through the linear filter of the average's
// own fit (pole_errors()): the pole that the hit would have given, to first order. Leaving out one
// hit at a time, n of them, then gives the average's variance (n - 1) / n sum (p_(h) - mean)^2,
// whatever noise on the force, its correlation between lines, or the structure have changed. Hits
// are weighed by their squared impulses, as H1 weighs them. Points struck one after the other are
// independent. Source: Efron, Tibshirani, An Introduction to the Bootstrap, ch. 11.
#pragma once

#include <vector>

#include "signal/modes/modal_band.h"
#include "signal/refinement/modal_noise.h"
#include "signal/refinement/modal_refine.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// Standard deviations of a mode of the average, with their degrees of freedom.
struct JackknifeOfHits {
  double frequency_std_hz = 0, damping_ratio_std = 0, freedom = 0;
};

/// Jackknife for the modes of `fit` by rising frequency. Empty where the set does not keep two hits
/// on some point over the whole band, or where the poles cannot be told apart.
[[nodiscard]] std::vector<JackknifeOfHits> jackknife_of_hits(const FrfSet& frfs,
                                                             const ModalBand& band,
                                                             const FrfNoise& noise,
                                                             const ModalRefineResult& fit);

}  // namespace rigfit::signal
