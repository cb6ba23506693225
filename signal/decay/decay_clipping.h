// Clipped samples of a decay seen from its fit: a fit to all other samples goes beyond the rail
// where they are.
//
// The samples at the record's extremes are left out, the rest is fitted, and the fit is compared
// there. In an unclipped record the extremes are its luckiest samples and the fit lies inside them.
// In a clipped record the fit lies outside, by more than the noise:
//   sum_j max(0, fit_j - rail)^2 / s^2 > chi-squared of as many degrees, 1e-4.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {

/// The samples on a rail, which say nothing of the decay but that it went there.
[[nodiscard]] std::vector<Eigen::Index> clipped_by_fit(const DecaySamples& samples,
                                                       const DecayBand& band);

}  // namespace rigfit::signal
