// EA and axial damping of a cable from hanging-mass tests: a mass M on a length lc of cable is
// struck, and the tension's decay gives the damped frequency wd and the damping ratio zeta.
//
//   omega^2 = wd^2 / (1 - zeta^2)       undamped frequency
//   kc = EA / lc from omega, M, the cable's own mass and the adapter in series (rod_stiffness.h)
//   c = 2 zeta sqrt(k M)
// Source: Jalali and Rideout 2021, axial test; their approximation of the cable's inertia is
// replaced by the exact rod.
//
// Other compliance in series with the cable (grips, load cell, frame, an adapter that was not
// stated) does not grow with length: with two or more lengths it is a free parameter of the fit
// (axial_fit.h), so that EA follows from the slope of 1/kc over length. One length cannot separate
// the two. Unless the frame is stated, EA then has bounds only (`conditional`): at least its value
// for a rigid frame (one-sided) and at most that of a solid metal bar with the cable's mass per
// length; the standard uncertainty is that of a rectangular density between them (GUM, 4.3.7).
//
// Lengths that disagree (chi-squared of the fit, 5 %) get a scatter of EA by Paule and Mandel, and
// Student's t with the fit's degrees of freedom. Expanded uncertainties from scatter (type A) and
// from other knowledge (type B) are added in squares (R. Willink, Metrologia 44 (2007) 340); 1/EA
// is symmetric. Damping ratios are averaged over records and lengths (estimation/groups.h).
#pragma once

#include <span>

#include "ident/axial/axial_result.h"

namespace rigfit::ident {

/// Throws std::invalid_argument, naming the record, for values that are not positive and finite,
/// when an adapter is softer than the whole measured chain, and when the lengths cannot be fitted.
/// Notes: one_length, lengths_too_close, lengths_disagree, series_compliance, length_std,
/// massless_cable, exact_inputs, below_catalogue, above_catalogue.
[[nodiscard]] AxialTestResult identify_axial(std::span<const AxialDecay> decays,
                                             const AxialSetup& setup,
                                             const AxialOptions& options = {});

}  // namespace rigfit::ident
