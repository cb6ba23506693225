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
// with g the modes, or the states, widens what tau alone gives where it is larger.
// FRFs the same, with the relative errors of their lines in place of frequencies; what they share
// (shared_sources.h) is taken out before. Lines that err together count as one: chi-square and its
// degrees of freedom are divided by t of frf_correlation.h for the probability.
// Sources: Paule and Mandel, J. Res. NBS 87 (1982) 377;
// Liang and Zeger, Biometrika 73 (1986) 13. For the update and its checks, not for users.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/update/update_problem.h"

namespace rigfit::ident {

/// Of the problem with no error of the model but the one that is allowed for, at q.
[[nodiscard]] UpdateFit misfit_of(const UpdateProblem& problem,
                                  const std::vector<UpdateMatch>& matches,
                                  const Eigen::VectorXd& q);

/// tau at q; 0 where chi2 is not above its degrees of freedom, or without any.
[[nodiscard]] double model_std_of(const UpdateProblem& problem,
                                  const std::vector<UpdateMatch>& matches,
                                  const Eigen::VectorXd& q);

/// Of FRFs, relative in every line: the same; the problem with its sources (shared_sources.h).
[[nodiscard]] double frf_model_std_of(const UpdateProblem& problem,
                                      const std::vector<UpdateMatch>& matches,
                                      const Eigen::VectorXd& q);

/// The larger of the covariances by modes and by states, each coordinate's variance for itself; of
/// the whitened residuals r and J of the problem. Zero with fewer than three clusters of a kind.
[[nodiscard]] Eigen::VectorXd clustered_variance(const UpdateProblem& problem,
                                                 const std::vector<UpdateMatch>& matches,
                                                 const Eigen::VectorXd& r,
                                                 const Eigen::MatrixXd& J);

}  // namespace rigfit::ident
