// Test and model of a fit laid over each other.
#pragma once

#include <vector>

#include "apps/report/fit/fit_outcome.h"
#include "apps/report/page/report_part.h"

namespace rigfit::apps {

/// FRFs and answers to a hit, a tab a state; no tab when nothing was recorded. Adds what each
/// computation took to `costs`.
[[nodiscard]] PlotGroup fit_overlays(const FitOutcome& of, std::vector<ModelCost>& costs);

}  // namespace rigfit::apps
