// What is wrong with a recording's channels, found without changing a sample.
//
// Each finding has a code for programs, a sentence for people and the samples it is about:
// `clipped` (flat tops at the extremes, at or below the nominal range), `missing` (NaN, empty),
// `dropouts` (runs of exactly the same value, mostly zero, inside a moving signal), `stuck` (no
// motion at all, or only in a part), `offset`, `drift`, `noise_floor`, `mains_hum` (50 or 60 Hz and
// harmonics), `one_bit`, `coarse_quantisation`, `spikes`. Times are the reader's business: its notes
// on them are repeated by `inspect`.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "signal/recording.h"

namespace rigfit::signal {

struct QualityOptions {
  /// Samples in a row at exactly the extreme value from which it counts as flat: two happen by
  /// chance in a smooth peak that is coarsely quantised, three seldom.
  int clip_run = 3;
  /// Flat tops that must be at one level, or samples at it in all, for "clipped" when no nominal
  /// range is known: one flat top may be a real plateau.
  int clip_tops = 2;
  /// At or above this share of the nominal range a sample counts as clipped.
  double range_share = 0.999;
  /// Samples of exactly the same value in a row that make a dropout, when the signal before and
  /// after moves by more than its quantum at nearly every sample.
  int dropout_run = 8;
  /// Mean over standard deviation above which an offset is reported.
  double offset_ratio = 1.0;
  /// Change of the mean from the first to the last tenth, in standard deviations of what is left
  /// when the trend is taken away, above which drift is reported.
  double drift_ratio = 1.0;
  /// Line over its neighbourhood, amplitude ratio, above which mains hum is reported. For noise the
  /// ratio's distribution has P(> r) = exp(-0.7 r^2) about its median: 5 is passed once in 4e7 lines.
  double hum_ratio = 5;
  /// Distinct steps over the rms below which quantisation is coarse: rounding noise of q / sqrt(12)
  /// is then more than 3 % of the rms.
  double steps_per_rms = 10;
};

struct QualityFinding {
  std::string code;
  std::string message;       ///< with numbers and units
  long samples = 0;          ///< concerned; 0: not countable
  Eigen::Index first = -1;   ///< sample where it begins; -1: everywhere
};

struct ChannelQuality {
  std::string channel;
  double min = 0, max = 0, mean = 0, rms = 0;  ///< SI, of the samples there are; NaN when none
  long missing_samples = 0;
  long clipped_samples = 0;
  long stuck_samples = 0;       ///< in runs of `dropout_run` or more
  double quantum = 0;           ///< smallest step between values, SI; 0: none found
  double noise_floor = 0;       ///< rms of the broadband floor, SI (from the median line of the spectrum)
  double mains_hz = 0;          ///< 50 or 60 where hum was found, else 0
  double mains_rms = 0;         ///< of the hum's lines, SI
  double drift = 0;             ///< change of the mean over the record, SI
  std::vector<QualityFinding> findings;
};

struct QualityResult {
  std::vector<ChannelQuality> channels;
};

[[nodiscard]] QualityResult check_quality(const Recording& recording,
                                          const QualityOptions& options = {});

struct RepairOptions {
  /// Runs of missing samples up to this long are bridged by a cubic through the two samples on either
  /// side (a line at the ends); 0: none.
  int bridge_samples = 0;
  /// Degree of the polynomial in time taken away from each channel; -1: none, 0: the mean.
  int detrend_degree = -1;
};

/// A copy with what was asked for done, each act noted in its `notes`. Longer gaps stay.
[[nodiscard]] Recording repaired(const Recording& recording, const RepairOptions& options);

}  // namespace rigfit::signal
