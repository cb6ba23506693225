// The tables of a fit and the same numbers for programs: parameters, errors, pairs, likeness of
// shapes.
#pragma once

#include <string>

#include "apps/report/fit/fit_outcome.h"
#include "apps/report/page/report_part.h"

namespace rigfit::apps {

/// "0.82 %"; a dash where there is none.
[[nodiscard]] std::string percent_words(double ratio);

void add_parameters(ReportPart& part, const FitOutcome& of);

/// Errors before, fitted and held out, by state. Returns the rms of all that was held out; NaN
/// without.
double add_errors(ReportPart& part, const FitOutcome& of);

void add_pairs(ReportPart& part, const FitOutcome& of);

/// MAC of every measured mode with every modelled one, where two sensors or more make shapes; the
/// modelled shapes as UFF.
void add_shapes(ReportPart& part, const FitOutcome& of);

}  // namespace rigfit::apps
