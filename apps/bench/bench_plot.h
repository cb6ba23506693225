// A study of speed against error as a figure: every method a series over time on logarithmic
// scales, with what is Pareto-optimal and the default marked.
#pragma once

#include "apps/bench/bench_study.h"
#include "apps/report/drawing/plot.h"

namespace rigfit::apps {

/// Without series where nothing of the study has a time and an error.
[[nodiscard]] Plot bench_plot(const BenchStudy& study);

}  // namespace rigfit::apps
