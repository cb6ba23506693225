// From FRFs to modes without initial guesses: candidates, one fit, groups, judgement.
//
// Candidates come from the stabilisation diagram (lscf.h) and from a matched filter over what is
// left (pole_scan.h), round after round until nothing is gained. The fit is separable least squares
// in windows around modes that overlap (pole_fit.h); which candidates are modes is told by
// pole_sweep.h. Each group (hit, or point) has its own pole as well. Where groups agree
// (chi-square, chance above 5 %), the pole is that of all together, its variance the fit's times
// what groups scatter beyond their own (Birge's ratio, at least 1). Where they differ, it is the
// mean over groups (groups.h), which is noted once (`groups_differ`). Intervals are Student's: std
// is such that +-1.96 std hold 95 %. A mode is doubtful where fewer than a third of the points (two
// thirds of the hits) see it, its damping is known to 25 % or worse, the window makes more than
// half of its decay rate, its fit leaves more than its own peak, or a single FRF shows it within a
// stronger one. What lies beyond the band is fitted (a quarter of its width) and not reported.
#pragma once

#include "signal/modes/modal_result.h"

namespace rigfit::signal {

/// Throws std::invalid_argument when the set is inconsistent in size, holds no FRF or fewer than 8
/// usable lines in the band. A set without any mode gives an empty list and a note.
[[nodiscard]] ModalResult identify_modes(const FrfSet& frfs, const ModalOptions& options = {});

}  // namespace rigfit::signal
