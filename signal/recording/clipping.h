// Clipping seen in the samples themselves: flat tops at a channel's extremes, also below the
// nominal range.
//
// A run of n >= 3 equal samples at an extreme is clipped when the signal leaves it by 3 quanta q or
// more: the top of a smooth signal in steps of q is a parabola that falls by q at most over n / 2
// samples; a logger that repeats its values holds the next ones for as long, and one that begins or
// ends at rest shows no edge there. Two equal samples are clipped when they are left by more than
// 100 q: the slope of a top as sharp puts them within a quantum of each other once in a hundred
// records. A level within 10 % of the span of the value at rest is no clipping.
#pragma once

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

/// The samples of a channel that are clipped.
struct ClippedSamples {
  std::vector<bool> at;        ///< by sample
  long count = 0;              ///< number of clipped samples
  Index first = -1;            ///< -1: none
  std::vector<double> levels;  ///< extremes they stand at, the high one first

  /// Whether one of samples first..last (inclusive) is.
  [[nodiscard]] bool any(Index first_sample, Index last_sample) const;
};

/// All samples at an extreme at which one run of them is clipped, and those that reach 0.999 of the
/// nominal range (0: not known).
[[nodiscard]] ClippedSamples clipped_samples(const Ref<const VectorXd>& channel,
                                             double nominal_range);

}  // namespace rigfit::signal
