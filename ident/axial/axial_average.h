// EA averaged over what may explain the lengths: the cable alone, or a compliance in series with
// it; the lengths as they are, or scattering by more than their uncertainties.
//
//   p(EA) = sum_k w_k p_k(EA),   w_k ~ likelihood of k at its best fit, times exp(-penalty)
//
// p_k: 1/EA is Student's t about the fit. The compliance has no penalty: with Akaike's (1) the 95 %
// interval holds 88.5 % where the compliance is 1.5 of its standard uncertainties, with Schwarz's
// (3 and more) 52 %, without 92.6 to 98.2 % everywhere; the width is at most 1.04 of the interval
// that always leaves the compliance free. Scatter has Akaike's, and where it would have to be
// told from one or two degrees of freedom that the slope leaves, 3 over their number more; both
// times the share that scatter has in the uncertainty, so that it comes in smoothly. Source:
// Burnham and Anderson, Model Selection and Multimodel Inference, 2nd ed. (2002), 2.9 and 4.3.
#pragma once

#include <span>
#include <vector>

#include "ident/axial/axial_fit.h"

namespace rigfit::ident {

struct AxialCandidate {
  AxialFit fit;
  double weight = 0;
  // Student's t of 1/EA: relative scale, and degrees of freedom (0: normal).
  double scale = 0, degrees = 0;
  /// Degrees of freedom of what the scatter between lengths leaves; 0: no scatter.
  double scatter_degrees = 0;
};

/// Heaviest first, weights summing to 1. `repeat_degrees`: of the variance of the records (0:
/// known). Empty when no fit converged. A fit of the slope that does not determine EA to 25 % is
/// left out; `slope_left_out` says so.
[[nodiscard]] std::vector<AxialCandidate> axial_candidates(std::span<const AxialLengthData> lengths,
                                                           const AxialSetup& setup,
                                                           double repeat_degrees, double coverage,
                                                           bool& slope_left_out);

/// EA below which the mixture has the share `p`.
[[nodiscard]] double axial_quantile(std::span<const AxialCandidate> candidates, double p);

}  // namespace rigfit::ident
