// Power of the noise in a force signal, line by line, measured where no force acts.
//
// A hammer's force is zero but for its pulse: what is recorded outside of it is noise. With r(t)
// its autocovariance there, noise under a window w has the mean power
//   E|N_k|^2 = sum_t r(t) a(t) exp(-2 pi i k t / N),   a(t) = sum_n w_n w_(n+t),
// whatever its colour (Wiener and Khinchin). r comes from the transforms of the samples outside the
// pulses, each lag divided by the number of pairs that make it up. Source: Bendat and Piersol,
// Random Data, 4th ed., sec. 11.4 (correlation functions by transforms).
#pragma once

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

/// Samples from fewer of which noise is not known: its standard deviation is off by a fifth or
/// more.
inline constexpr Index kFewestForNoise = 16;
/// A line whose force lies this far below its maximum, dB, is not excited. ISO 7626-5 asks for a
/// spectrum that is reasonably flat; 20 dB is the customary outer limit.
inline constexpr double kMostSpectrumDrop = 20;

/// One hit: views into recordings, all beginning at the same instant. A view shorter than the block
/// is continued by zeros (after its offset is subtracted).
struct FrfBlock {
  std::span<const double> force;
  std::vector<std::span<const double>> responses;
  double force_offset = 0;              ///< subtracted
  std::vector<double> response_offset;  ///< subtracted; empty: zeros
  Index force_first = 0;                ///< samples of force kept as they are: from this ...
  Index force_last = -1;                ///< ... to the one before this; -1: all of it
  Index force_taper = 0;                ///< samples of fading on either side, zero beyond
  /// Samples of the block that are not noise of the force: the pulse with what may ring around it.
  Index pulse_first = 0, pulse_last = -1;  ///< -1: not known, nor is the noise
  std::vector<double> response_noise_std;  ///< std of each response's noise; empty: unknown
};

struct ForceNoise {
  VectorXd power;  ///< lines, those of tones (mains hum) as they are
  /// The part that is smooth over lines. A tone is left out of it: one tone's cross product with
  /// the force is no mean of zero over a few hits, subtracting its power would make H wrong.
  VectorXd broadband;
};

/// Mean over the blocks, unscaled sums as `FrfEstimate::force_power`, `block_samples` / 2 + 1
/// lines: of the noise that each block's force window and the exponential window leave. Smoothed
/// over some `smoothing_lines` on either side. Empty where it is not known: fewer than
/// kFewestForNoise samples outside the pulses of all blocks, or a block that does not say where its
/// pulse is.
[[nodiscard]] ForceNoise force_noise_power(std::span<const FrfBlock> blocks, Index block_samples,
                                           const VectorXd& exponential, Index smoothing_lines);

}  // namespace rigfit::signal
