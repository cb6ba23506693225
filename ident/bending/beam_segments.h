// The elastic part of a load-deflection record of a beam without tension (strokes of 40 samples and
// more): toe, elastic part, and yield or a stop, as straight segments. Inside of bending_analysis.
//
// Samples are averaged in up to 60 bins of equal length along the curve, both axes relative to
// their ranges. For k = 1 to 5 segments the breaks with the least sum of squared distances from
// their lines follow by dynamic programming (total least squares: toes lie flat, stops stand
// upright). More segments are taken when an F-test on the bins' distances, 3 parameters a segment,
// gives under 1 % times the number of places for the breaks; the variance is what the better fit
// leaves, no less than the resolution of the numbers. Neighbours whose slopes differ by less than
// `kCurvatureWarning` are one.
//
//   toe      segments up to a quarter of the load, each followed by a steeper one
//   elastic  the first segment after them; its line is Deming's, with the change of slope within it
//            in the uncertainty
//   stop     what follows is three times as steep or more;  yield: it is less steep
//
// A second segment that is steeper by less is a curve, which has no one EI. Sources: Bellman and
// Roth 1969 (segments); Draper and Smith, Applied Regression Analysis, 6.1 (F-test); ISO 178, 3
// (toe).
#pragma once

#include <vector>

#include "ident/bending/bending_result.h"
#include "ident/bending/bending_strokes.h"

namespace rigfit::ident {

struct ElasticPart {
  BendingStroke stroke;  ///< stiffness NaN: no elastic part
  double degrees_of_freedom = 0;
  std::vector<BendingFinding> findings;  ///< "toe", "stop", "yield", "break", "curved"
};

[[nodiscard]] ElasticPart find_elastic_part(const StrokeRange& run, const StrokeData& data);

}  // namespace rigfit::ident
