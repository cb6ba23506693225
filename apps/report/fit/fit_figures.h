// Test and model of a fit laid over each other.
#pragma once

#include "apps/report/fit/fit_outcome.h"
#include "apps/report/page/report_part.h"

namespace rigfit::apps {

/// FRFs, a tab a state; no tab when nothing was recorded.
[[nodiscard]] PlotGroup fit_overlays(const FitOutcome& of);

}  // namespace rigfit::apps
