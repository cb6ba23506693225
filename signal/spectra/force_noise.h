// Power of the noise in a force signal, line by line, measured where no force acts.
//
// A hammer's force is zero but for its pulse: what is recorded outside of it is noise. With r(t)
// its autocovariance there, noise under a window w has the mean power
//   E|N_k|^2 = sum_t r(t) a(t) exp(-2 pi i k t / N),   a(t) = sum_n w_n w_(n+t),
// whatever its colour (Wiener and Khinchin). r comes from the transforms of the samples outside the
// pulses, each lag divided by the number of pairs that make it up. Source: Bendat and Piersol,
// Random Data, 4th ed., sec. 11.4 (correlation functions by transforms).
#pragma once

#include <Eigen/Core>
#include <span>

#include "signal/spectra/frf.h"

namespace rigfit::signal {

struct ForceNoise {
  Eigen::VectorXd power;  ///< lines, those of tones (mains hum) as they are
  /// The part that is smooth over lines. A tone is left out of it: one tone's cross product with
  /// the force is no mean of zero over a few hits, subtracting its power would make H wrong.
  Eigen::VectorXd broadband;
};

/// Mean over the blocks, unscaled sums as `FrfEstimate::force_power`, `block_samples` / 2 + 1
/// lines: of the noise that each block's force window and the exponential window (empty: none)
/// leave. Smoothed over some `smoothing_lines` on either side. Empty where it is not known: fewer
/// than 32 samples outside the pulses of all blocks, or a block that does not say where its pulse
/// is.
[[nodiscard]] ForceNoise force_noise_power(std::span<const FrfBlock> blocks,
                                           Eigen::Index block_samples,
                                           const Eigen::VectorXd& exponential,
                                           Eigen::Index smoothing_lines);

}  // namespace rigfit::signal
