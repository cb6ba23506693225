// Resamples a recording to another rate, or to uniform times where its times are uneven.
//
// For uneven times a cubic spline (natural ends, GSL) through the samples is evaluated at uniform
// times. For uniform times a Kaiser-windowed sinc (80 dB) is used, which passes up to 0.4 of the
// lower of the two rates and stops from 0.5 of it on: no aliasing. Source: Oppenheim and Schafer,
// Discrete-Time Signal Processing, 3rd ed., sec. 7.6 (window design).
#pragma once

#include "signal/recording/recording.h"

namespace rigfit::signal {

struct ResampledChannel {
  std::string name, unit;
  double error_rms = 0;

  static constexpr std::string_view title = "largest error, but at the two ends";
  static constexpr auto fields() {
    using T = ResampledChannel;
    return std::tuple{field("name", &T::name, "", "channel", ""),
                      field("unit", &T::unit, "", "unit", ""),
                      field("error_rms", &T::error_rms, "", "rms",
                            "at most, in its unit, but at the record's two ends", 2)};
  }
};

struct ResampleResult {
  Recording recording;  ///< even, at the rate asked for; notes say what was done
  double from_hz = 0;   ///< rate before; for uneven times from the median step
  /// Each with its rms error. For the spline every second sample is compared with the spline
  /// through the others: an upper bound, since these are twice as far apart. For the filter it is
  /// 1e-4 of the channel's rms, except within the filter's half length of the two ends.
  std::vector<ResampledChannel> channels;

  static constexpr auto fields() {
    using T = ResampleResult;
    return std::tuple{
        field("from_hz", &T::from_hz, "Hz", "", "rate before"),
        field("sample_rate_hz", describe::within(&T::recording, &Recording::sample_rate_hz), "Hz",
              "rate", "", 9),
        field("samples", describe::within(&T::recording, &Recording::samples), "", "samples", ""),
        field("channels", &T::channels, "", "channels", "")};
  }
};

/// `rate_hz` 0 takes the rate of the median step. Throws RecordingError for a recording without
/// times or rate, with fewer than 8 samples before or after, with missing or clipped samples, or
/// with times that do not rise or have gaps.
[[nodiscard]] ResampleResult resampled(const Recording& recording, double rate_hz);

/// The recording with each of its samples at the nearest of even times, the values as they are and
/// NaN where there is none; `late` says what that leaves of their own times. Empty: the times are
/// even or do not rise, two samples have one place, or most places would be empty.
[[nodiscard]] std::optional<Recording> placed_evenly(const Recording& recording);

}  // namespace rigfit::signal
