// How well a fit agrees with the uncertainties of its data, and the random effect of the model
// where it does not.
//
// With e_i = ln(f_model / f_measured) and s_i stated, chi2 = sum e_i^2 / s_i^2 + the rest
// (dampings, shapes, priors). Where its probability is below 5 %, the model's own error tau is the
// root of
//   sum e_i^2 / (s_i^2 + tau^2) + the rest = degrees of freedom   (Paule and Mandel)
// and the fit goes on with these weights. Errors of a model are not independent: one that is wrong
// in a mode is so in every state. The covariance by clusters
//   B (sum_g J_g' r_g r_g' J_g) B G / (G - 1),  B = (J' J)^-1,
// with g the modes, or the states, widens what tau alone gives where it is larger. chi2 is the
// least over all coordinates: what is known to an uncertainty explains what it can
// (update_nuisances.cc). FRFs have the relative errors of their lines in the place of frequencies.
// Sources: Paule and Mandel, J. Res. NBS 87 (1982) 377; Liang and Zeger, Biometrika 73 (1986) 13.
// For the update and its checks, not for users.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

/// Probability of a misfit below which the model errs.
inline constexpr double kUnlikelyMisfit = 0.05;

/// Misfit at q, the minimum of a problem without an error of the model.
[[nodiscard]] UpdateFit misfit_of(const UpdateProblem& problem,
                                  const std::vector<UpdateMatch>& matches,
                                  const Eigen::VectorXd& q);

/// tau about that minimum, of frequencies, or of the lines of FRFs where there are any; 0 where
/// chi2 is not above its degrees of freedom, or without any.
[[nodiscard]] double model_std_of(const UpdateProblem& problem,
                                  const std::vector<UpdateMatch>& matches,
                                  const Eigen::VectorXd& q);

/// The larger of the covariances by modes and by states, each coordinate's variance for itself; of
/// the whitened residuals r and J of the problem. Zero with fewer than three clusters of a kind.
[[nodiscard]] Eigen::VectorXd clustered_variance(const UpdateProblem& problem,
                                                 const std::vector<UpdateMatch>& matches,
                                                 const Eigen::VectorXd& r,
                                                 const Eigen::MatrixXd& J);

}  // namespace rigfit::ident
