// Poles that a set of FRFs still shows, by a matched filter over lines and widths.
//
// At every line and for half bandwidths of 1/2, 2, 8, ... lines the resonance 1/(s - p) less what a
// quadratic background has of it, y, is held against the residuals r_c of a window of 15 half
// bandwidths (12 lines at least; one-sided near the ends):
//   F = mean_c |y^H r_c|^2 / (|r_c|^2 - |y^H r_c|^2) dof,   |y| = 1, r_c without background.
// A resonance between two widths loses 6 % of its amplitude. Maxima count as poles where noise
// gives one of them all with a chance below 1e-3. Wider than 2 lines, lines are averaged by fours
// first: the work is that of the two narrowest widths, times 1.4.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "signal/modal/modal_data.h"

namespace rigfit::signal {

/// Chance of taking noise for a mode anywhere in the band.
inline constexpr double kNoiseChance = 1e-3;
/// Noise beside a candidate is known from what the fit leaves to such a factor: with a hundred FRFs
/// chance alone would take a tenth more for a mode.
inline constexpr double kNoiseKnown = 1.5;

/// `residual`: lines of `data` x columns.
[[nodiscard]] std::vector<std::complex<double>> scan_poles(
    const ModalData& data, const Eigen::Ref<const Eigen::MatrixXcd>& residual);

}  // namespace rigfit::signal
