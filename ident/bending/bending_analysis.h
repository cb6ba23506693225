// Analyses a bending test: from load, deflection and tension of a clamped, tensioned cable loaded
// at mid-span to the slope d/Q and EI.
//
//   Q = c + K (d - d0) g(P),   g(P) = compliance(EI, mean P) / compliance(EI, P)
//
// K, the stiffness at the mean tension, is the slope of a straight line in x = (d - d0) g. The
// factor g corrects for the change of tension under load; it hardly depends on EI, which is
// iterated. Each stroke (loading, unloading) has its own line: wire friction shifts them apart and
// bends their beginnings. The line is Deming's (errors in both channels, ratio of variances from
// the channels' own noise) with Huber weights. Its variance is the larger of the textbook formula's
// and of a block jackknife's, which allows for correlated residuals within a stroke. Strokes are
// pooled with the scatter between them (estimation/groups.h), degrees of freedom after Welch and
// Satterthwaite (GUM G.4). Where loading and unloading lie apart, wire friction stiffens the
// strand after every turn: the strokes lose kFrictionShare of their travel instead of kTurnShare,
// and the slope moves on by the change that this made, with the same as its standard uncertainty:
// of the transient, one law of friction leaves nothing, another twice that.
// `stiffness_from_compliance` then gives EI.
//
// Without tension (`ends` clamped, pinned or cantilever) the tension of a record is not used, the
// straight part of long strokes is the elastic one between toe and yield or stop
// (beam_segments.h), and EI = L^3 / (c s).
#pragma once

#include <vector>

#include "ident/bending/bending_result.h"

namespace rigfit::ident {

/// Throws std::invalid_argument for channels of different lengths or a span that is not positive.
[[nodiscard]] BendingTestResult analyse_bending_test(const BendingRecord& record,
                                                     const BendingTestOptions& options);

/// Splits a table of points taken at several tensions into one record per tension: clusters that
/// are more than 5 % of the tension and more than their own spread apart.
[[nodiscard]] std::vector<BendingRecord> split_by_tension(const BendingRecord& table);

}  // namespace rigfit::ident
