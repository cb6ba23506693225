// Frequencies of a mode as every struck point shows them by itself: their scatter and their trend,
// beside the mean that stands for the mode.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/report/page/report_part.h"
#include "signal/modal/modal_identification.h"

namespace rigfit::apps {

/// Deviations from each mode's mean over the points, parts per million, with the points' own 95 %
/// bars; lines: trends beyond chance. None when no mode was measured at several points.
[[nodiscard]] std::optional<Plot> points_plot(const std::string& id,
                                              const std::vector<signal::IdentifiedMode>& modes,
                                              Origin origin);

/// The same as numbers: mean, scatter between points, trend, lowest and highest point.
[[nodiscard]] std::optional<ReportTable> points_table(
    const std::string& id, const std::vector<signal::IdentifiedMode>& modes, Origin origin);

}  // namespace rigfit::apps
