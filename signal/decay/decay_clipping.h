// Samples cut off at a rail: a fit to the others goes beyond it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {

/// Which of the samples (places in `samples.t`) sit on a rail. Those at either extreme are left out
/// and the rest is fitted anew; the rail has cut them off where that fit goes beyond it by more
/// than noise explains once in 1e4 times and six times as far, squared, as it errs near by.
/// `whole`: the fit to all. One
/// or two samples are asked about only where `whole` goes beyond them.
[[nodiscard]] std::vector<Eigen::Index> clipped_samples(const DecaySamples& samples,
                                                        const DampedSinusoidsFit& whole,
                                                        const DecayBand& band);

/// `samples` without those at `places` (rising).
[[nodiscard]] DecaySamples without(const DecaySamples& samples,
                                   const std::vector<Eigen::Index>& places);

}  // namespace rigfit::signal
