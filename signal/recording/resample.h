// Resamples a recording to another rate, or to uniform times where its times are uneven.
//
// For uneven times a cubic spline (natural ends, GSL) through the samples is evaluated at uniform
// times. For uniform times a Kaiser-windowed sinc (80 dB) is used,
// which passes up to 0.4 of the lower of the two rates and stops from 0.5 of it on: no aliasing.
// Source: Oppenheim and Schafer, Discrete-Time Signal Processing, 3rd ed., sec. 7.6 (window
// design).
#pragma once

#include <string>
#include <vector>

#include "signal/recording/recording.h"

namespace rigfit::signal {

struct ResampleResult {
  Recording recording;  ///< even, at the rate asked for; notes say what was done
  double from_hz = 0;   ///< rate before; for uneven times from the median step
  /// Rms error of each channel, in its unit. For the spline each sample is compared with the spline
  /// through the others: an upper bound, since these are twice as far apart. For the filter it is
  /// 1e-4 of the channel's rms.
  std::vector<double> error_rms;
};

/// `rate_hz` 0 takes the rate of the median step. Throws RecordingError for a recording without
/// times or rate, with fewer than 8 samples before or after, with missing or clipped samples, or
/// with times that do not rise or have gaps.
[[nodiscard]] ResampleResult resampled(const Recording& recording, double rate_hz);

}  // namespace rigfit::signal
