// What a check of quality is asked and what it finds (quality.h).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "signal/recording/recording.h"

namespace rigfit::signal {

/// Thresholds of the checks.
struct QualityOptions {
  /// Samples in a row at exactly the extreme value from which it counts as flat: two happen by
  /// chance in a smooth peak that is coarsely quantised, three seldom.
  int clip_run = 3;
  /// A flat top counts when the signal enters or leaves it by at least so many quanta: a smooth
  /// peak does so by one.
  double clip_step_quanta = 3;
  /// At or above this share of the nominal range a sample counts as clipped.
  double range_share = 0.999;
  /// Samples of exactly the same value in a row that can make a dropout.
  int dropout_run = 8;
  /// They do when runs as long are that improbable, given how often neighbouring samples are equal
  /// around them (a signal at rest, coarsely quantised, repeats itself): expected number of such
  /// runs.
  double dropout_chance = 1e-3;
  /// Mean over standard deviation above which an offset is reported.
  double offset_ratio = 1.0;
  /// Change of the median from the first to the last tenth, in standard deviations of what is left
  /// when that trend is taken away, above which drift is reported.
  double drift_ratio = 1.0;
  /// Amplitude of a line over the median of its neighbourhood above which it can be mains hum; in
  /// white noise P(> r) = 2^(-r^2): once in 3e7 lines for 5.
  double hum_ratio = 5;
  /// Mains hum is steady: its largest amplitude in a quarter of the record over its smallest. The
  /// decay of a mode near 50 Hz is not.
  double hum_steadiness = 2;
  /// Quanta in a standard deviation below which quantisation is coarse: its rounding noise,
  /// q / sqrt(12), is then more than 3 % of the signal.
  double steps_per_rms = 10;
};

/// Something found wrong, with its code in JSON.
struct QualityFinding {
  std::string code;
  std::string message;      ///< with numbers and units
  long samples = 0;         ///< concerned; 0: not countable
  Eigen::Index first = -1;  ///< sample where it begins; -1: everywhere
};

/// Figures and findings of one channel.
struct ChannelQuality {
  std::string channel;
  double min = 0, max = 0, mean = 0, rms = 0;  ///< SI, of the samples there are; NaN when none
  long missing_samples = 0;
  long clipped_samples = 0;
  long stuck_samples = 0;  ///< in runs of `dropout_run` or more
  double quantum = 0;      ///< smallest step between values, SI; 0: none found
  double noise_floor =
      0;                 ///< rms of the broadband floor, SI (from the median line of the spectrum)
  double mains_hz = 0;   ///< 50 or 60 where hum was found, else 0
  double mains_rms = 0;  ///< of the hum's lines, SI
  double drift = 0;      ///< change of the mean over the record, SI
  std::vector<QualityFinding> findings;
};

/// One entry a channel, in the recording's order.
struct QualityResult {
  std::vector<ChannelQuality> channels;
};

}  // namespace rigfit::signal
