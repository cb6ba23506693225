// EA and axial damping of a cable from hanging-mass tests: a mass M on a length lc of cable,
// struck, its damped frequency and damping ratio read from the tension's decay.
//
//   omega^2 = wd^2 / (1 - zeta^2)       undamped
//   kc = EA / lc from omega, M, the cable's own mass and the adapter km in series (rod_stiffness.h;
//   to first order kc = omega^2 (M + m lc / 3) for a rigid adapter),   c = 2 zeta sqrt(k M)
// Source: Jalali and Rideout 2021, axial test; the cable's inertia without its approximation.
//
// EA follows from least squares over all lengths (axial_fit.h). What else gives way in series with
// the cable (grips, load cell, frame, an adapter that was not told) does not grow with length: the
// slope of 1/kc over length is 1/EA whatever it is, the plain fit is 1/EA only without it. Both are
// fitted and averaged by their likelihoods (axial_average.h). Lengths which disagree beyond their
// own uncertainty widen the answer; Cochran's Q tests whether EA is the same. One length cannot
// tell: unless the frame is told, it gives the stiffness of the whole chain, and of EA a lower
// bound (axial_bound.h); `conditional` says so. Uncertainty by the GUM (JCGM 100), with a budget,
// and by Monte Carlo (JCGM 101) on closed forms, a second way through (axial_monte_carlo.h).
//
// Damping ratios are averaged over records and lengths (signal/estimation/groups.h): the weighted
// mean is the least-squares solution of a model linear in its one unknown, and needs no iteration.
#pragma once

#include <span>

#include "ident/axial/axial_result.h"

namespace rigfit::ident {

/// Throws std::invalid_argument, naming the record, for values that are not positive and finite,
/// and when an adapter is softer than the whole chain that was measured or the lengths cannot be
/// fitted.
[[nodiscard]] AxialTestResult axial_test(std::span<const AxialDecay> decays,
                                         const AxialSetup& setup, const AxialOptions& options = {});

}  // namespace rigfit::ident
