// A record brought down to the rate that the modes of a band need.
//
// Where a band is asked for, what lies far above it only hides its modes and costs time. The record
// is filtered and every `step`-th sample is kept; the decay is then fitted there:
//   x_i = sum_k h_k y_(first + i step + k),   |k| < 4.3 step
// with h a sinc that cuts off at half the rate of x under Kaiser's window of 100 dB: what lies
// below 1/8 of that rate is unchanged, what lies above 7/8, and would be folded to there, is gone.
// Poles and amplitudes are those of the record, and so are their Cramer-Rao bounds, as noise
// outside of the band holds nothing of the modes. Source: Harris, Multirate Signal Processing
// (2004), ch. 3.
#pragma once

#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {

struct NarrowRecord {
  VectorXd samples;
  Index first = 0, step = 1;  ///< samples[i] is that of record sample first + i step
  double noise_gain = 1;      ///< on the std of white noise

  [[nodiscard]] Index record_sample(Index sample) const { return first + sample * step; }
};

/// `y` in `band`. Nothing where every sample is needed or the filter is longer than the record, or
/// where there are gaps or rails.
[[nodiscard]] std::optional<NarrowRecord> narrow_record(const Ref<const VectorXd>& y,
                                                        const DecayBand& band);

}  // namespace rigfit::signal
