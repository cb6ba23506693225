// A bending test from its records: load at mid-span of a clamped, tensioned cable, deflection and
// tension as measured, to the slope d/Q and EI.
//
//   Q = c + K (d - d0) g(P),   g(P) = compliance(EI, mean P) / compliance(EI, P)
//
// K, the stiffness at the mean tension, is the slope of a straight line in x = (d - d0) g; g takes
// out that the tension changes while the cable is loaded and hardly depends on EI, which is
// iterated. Each stroke (loading, unloading) has its own line: wire friction shifts them apart and
// bends their beginnings. Line: Deming's (errors in both channels, ratio of variances from the
// channels' own noise), Huber weights; variance from the larger of the textbook formula and a block
// jackknife, which sees that residuals of one stroke are not independent. Strokes are pooled with
// the scatter between them (estimation/groups.h), degrees of freedom after Welch and
// Satterthwaite (GUM G.4). Where strokes have 40 samples or more the slope is averaged over what
// wire friction may do after the turns (friction_transient.h), with the spread between its laws in
// the uncertainty. Then `stiffness_from_compliance`.
//
// Without tension (`ends` clamped, pinned or cantilever) the tension of a record is not used, the
// straight part of long strokes is the elastic one between toe and yield or stop
// (beam_segments.h), and EI = L^3 / (c s) (beam_ends.h).
#pragma once

#include <vector>

#include "ident/bending/bending_result.h"

namespace rigfit::ident {

/// Throws std::invalid_argument for channels of different lengths or a span that is not positive.
[[nodiscard]] BendingTestResult analyse_bending_test(const BendingRecord& record,
                                                     const BendingTestOptions& options);

/// Splits a table of points taken at several tensions into one record a tension: clusters of the
/// tension separated by more than 5 % of it and by more than their own spread.
[[nodiscard]] std::vector<BendingRecord> split_by_tension(const BendingRecord& table);

}  // namespace rigfit::ident
