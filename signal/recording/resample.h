// A recording at another rate, or at an even one where its times are uneven.
//
// Uneven times: a cubic spline (natural ends, GSL) through the samples, evaluated at even times; no
// value inside a gap. Even times: a Kaiser-windowed sinc (80 dB), flat to 0.4 of the lower of the
// two rates and closed from 0.5 of it on, so that nothing is folded. Source: Oppenheim and Schafer,
// Discrete-Time Signal Processing, 3rd ed., sec. 7.6 (window design).
#pragma once

#include <string>
#include <vector>

#include "signal/recording/recording.h"

namespace rigfit::signal {

struct ResampleResult {
  Recording recording;  ///< even, at the rate asked for; notes say what was done
  double from_hz = 0;   ///< rate before; of uneven times the median step's
  /// rms error of each channel, in its unit. Of the spline: every sample against the spline through
  /// the others, an upper bound, since the others stand twice as far apart; of the filter: 1e-4 of
  /// the channel's rms.
  std::vector<double> error_rms;
};

/// `rate_hz` > 0; 0 for the rate of the median step. Throws RecordingError without times or rate,
/// for fewer than 8 samples before or after, samples that are missing, and times that do not rise.
[[nodiscard]] ResampleResult resampled(const Recording& recording, double rate_hz);

}  // namespace rigfit::signal
