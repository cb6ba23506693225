// What may be mended in a recording, and only when somebody asks for it.
#pragma once

#include "signal/recording/recording.h"

namespace rigfit::signal {

struct RepairOptions {
  /// Runs of missing samples up to this long are bridged by a cubic through the two samples on
  /// either side (a line at the ends); 0: none.
  int bridge_samples = 0;
  /// Degree of the polynomial in time taken away from each channel; -1: none, 0: the mean.
  int detrend_degree = -1;
};

/// A copy with what was asked for done, each act noted in its `notes`. Longer gaps stay.
[[nodiscard]] Recording repaired(const Recording& recording, const RepairOptions& options);

}  // namespace rigfit::signal
