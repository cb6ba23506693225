// A recording as figures: every channel over time, with what its quality check found.
#pragma once

#include <string>
#include <vector>

#include "apps/report/drawing/plot.h"
#include "signal/quality/quality.h"
#include "signal/recording/recording.h"

namespace rigfit::apps {

/// The channels of a recording over time, linked. Clipped samples are points, other findings marks
/// where they begin and words in the caption. Long channels keep the extremes of short stretches.
/// Empty for what is not over time.
[[nodiscard]] std::vector<Plot> recording_plots(const std::string& id,
                                                const signal::Recording& recording,
                                                const signal::QualityResult& quality,
                                                Origin origin);

/// Samples over time with at most about `most` points: the extremes of equal stretches, in order.
void add_samples(PlotSeries& series, const Eigen::Ref<const Eigen::VectorXd>& samples,
                 double start_s, double rate_hz, std::size_t most = 6000);

}  // namespace rigfit::apps
