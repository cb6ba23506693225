// Lines of FRFs that err together.
//
// The noise that a force window leaves, the smallest part of a place that is not told and a model
// that is a little off move neighbouring lines alike, and all responses of a load. With z_k the
// complex residual of line k after the fit, over its standard deviation,
//   R_l = mean Re(conj(z_k) z_(k+l)) / 2
// correlates each FRF with itself and with those of the same load. For the probability of the
// misfit lines count as one by the integrated autocorrelation time t = 1 + 2 sum_l R_l / R_0, up to
// the first R_l / R_0 below 2 / sqrt(lines) (Bartlett's effective number of samples). A parameter
// feels the correlation only as far as its derivatives reach, which is the width of a resonance:
// its variance is that of the sandwich
//   B M B,  B = (J' J)^-1,  M = sum of s_g s_g', s_g = J' r of a block of 2 t lines of all
//   responses of a load (other data: their part of J' J),
// and at least R_0 t B. Sources: Bartlett, J. R. Stat. Soc. 98 (1935) 536; White, Econometrica 48
// (1980) 817; Liang and Zeger, Biometrika 73 (1986) 13. For the update and its checks, not
// for users.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

/// t of the residuals r of the problem's FRFs, 1 or more; 1 without FRFs.
[[nodiscard]] double correlated_lines_of(const UpdateProblem& problem,
                                         const std::vector<UpdateMatch>& matches,
                                         const Eigen::VectorXd& r);

/// The largest ratio of a parameter's variance to that in B, of B M B or of R_0 t B, from residuals
/// and derivatives at the answer. 0 without FRFs.
[[nodiscard]] double correlated_variance_factor(const UpdateProblem& problem,
                                                const std::vector<UpdateMatch>& matches,
                                                const Eigen::VectorXd& r, const Eigen::MatrixXd& J);

}  // namespace rigfit::ident
