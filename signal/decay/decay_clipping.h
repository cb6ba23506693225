// Clipped samples of a decay seen from its fit: a fit to all other samples goes beyond the rail
// where they are.
//
// Too few samples on a rail to pile up there (clipping.h) still bias a damping ratio. Those at the
// record's extremes are left out, the rest is fitted, and the fit is compared there. In an
// unclipped record the extremes are its luckiest samples and the fit lies inside them. In a clipped
// record the fit lies outside, by more than the noise and by more than the fit errs within a cycle
// around them (friction, jitter and close modes make it err everywhere):
//   sum_j max(0, fit_j - rail)^2 / s^2 > chi-squared of as many degrees, 1e-4.
#pragma once

#include <Eigen/Core>

#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {

/// One past the last sample on a rail; 0: none that the fit tells. `whole`: the fit to all samples.
[[nodiscard]] Eigen::Index clipped_by_fit(const DecaySamples& samples,
                                          const DampedSinusoidsFit& whole, const DecayBand& band,
                                          const DecayModesOptions& options);

}  // namespace rigfit::signal
