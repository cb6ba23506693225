// EA and axial damping of a cable from hanging-mass tests: a mass M on a length lc of cable,
// struck, its damped frequency and damping ratio read from the tension's decay.
//
//   omega^2 = wd^2 / (1 - zeta^2)       undamped
//   kc = EA / lc from omega, M, the cable's own mass and the adapter in series (rod_stiffness.h)
//   c = 2 zeta sqrt(k M)
// Source: Jalali and Rideout 2021, axial test; the cable's inertia without its approximation.
//
// What else gives way in series with the cable (grips, load cell, frame, an adapter that was not
// told) does not grow with length: from two lengths on it is a free parameter of the fit
// (axial_fit.h), so that EA is the slope of 1/kc over length. One length cannot tell: unless the
// frame is told, EA is then known from below only (`conditional`), at least its value for a rigid
// frame (one-sided) and at most what a bar of solid metal with the cable's mass per length has; the
// standard uncertainty between the two bounds is that of a rectangular density (GUM, 4.3.7).
//
// Lengths that disagree (chi-squared of the fit, 5 %) get a scatter of EA by Paule and Mandel, and
// Student's t with the fit's degrees of freedom. Expanded uncertainties of what is known from
// scatter and of the rest are added in squares (R. Willink, Metrologia 44 (2007) 340); 1/EA is
// symmetric. Damping ratios are averaged over records and lengths (estimation/groups.h).
#pragma once

#include <span>

#include "ident/axial/axial_result.h"

namespace rigfit::ident {

/// Throws std::invalid_argument, naming the record, for values that are not positive and finite,
/// and when an adapter is softer than the whole chain that was measured or the lengths cannot be
/// fitted. Notes: one_length, lengths_too_close, lengths_disagree, series_compliance, length_std,
/// massless_cable, exact_inputs, below_catalogue, above_catalogue.
[[nodiscard]] AxialTestResult identify_axial(std::span<const AxialDecay> decays,
                                             const AxialSetup& setup,
                                             const AxialOptions& options = {});

}  // namespace rigfit::ident
