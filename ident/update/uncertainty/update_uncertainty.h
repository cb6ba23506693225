// What is uncertain in an update: misfit, covariance and budget, predictions, 95 % intervals
// (formulas in model_update.h). For the update and its checks, not for users.
//
// Misfit: how well a fit agrees with the uncertainties of its data, and the random effect of the
// model where it does not.
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
//
// Intervals: linear in the fitted coordinate, q +- k std, where the cost is a parabola as far as
// that. It is not where the deviance at the linear ends, with all others moved along, is off k^2 by
// more than a quarter, or where any parameter lies within its interval of a bound: then the
// interval is that of the profile, where the least cost with the parameter held, all others fitted
// anew, exceeds the least by k^2 / 2. A parameter that the data cannot tell may still be bounded to
// one side. Where there are several answers the interval is that of the mixture of all, by their
// weights. Source: Bates and Watts, Nonlinear Regression Analysis and its Applications,
// 1988, 6.1.2.
#pragma once

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

/// Probability of a misfit below which the model errs.
inline constexpr double kUnlikelyMisfit = 0.05;

/// Misfit at q, the minimum of a problem without an error of the model.
[[nodiscard]] UpdateFit misfit_of(const UpdateProblem& problem,
                                  const std::vector<UpdateMatch>& matches, const VectorXd& q);

/// tau about that minimum, of frequencies, or of the lines of FRFs where there are any; 0 where
/// chi2 is not above its degrees of freedom, or without any.
[[nodiscard]] double model_std_of(const UpdateProblem& problem,
                                  const std::vector<UpdateMatch>& matches, const VectorXd& q);

/// Fills everything in `result` that is uncertain, from its coordinates.
void state_uncertainty(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                       UpdateResult& result);

/// Fills model_std_hz of pairs as modelled at `q`. `held_out`: a state whose own values are taken
/// as they are (where they have no prior); -1: none.
void state_prediction_uncertainty(const UpdateProblem& problem, const UpdateResult& result,
                                  const VectorXd& q, int held_out, std::vector<UpdatedPair>& pairs);

/// low, high and interval_by_profile of the result's parameters.
void state_intervals(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                     UpdateResult& result);

/// low and high of the result's parameters, over its alternatives.
void state_mixture(UpdateResult& result);

}  // namespace rigfit::ident
