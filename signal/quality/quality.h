// What is wrong with a recording's channels, found without changing a sample.
//
// Each finding has a code for programs, a sentence for people and the samples it is about:
// `clipped` (flat tops at the extremes, at or below the nominal range), `missing` (NaN, empty),
// `dropouts` (runs of exactly the same value, mostly zero, inside a moving signal), `stuck` (no
// motion at all, or only in a part), `offset`, `drift`, `noise_floor`, `mains_hum` (50 or 60 Hz and
// harmonics), `one_bit`, `coarse_quantisation`. Times are the reader's business: its notes
// on them are repeated by `inspect`.
#pragma once

#include "signal/quality/quality_result.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// Checks every channel of a recording.
[[nodiscard]] QualityResult check_quality(const Recording& recording,
                                          const QualityOptions& options = {});

}  // namespace rigfit::signal
