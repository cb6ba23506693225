// Misfit of a fit, the model's error that it asks for, and the posterior of the parameters, to
// first order.
//
// With P and N the columns of the Jacobian by parameters and nuisances, data rows over their
// standard deviations, the nuisances are integrated out: residuals have the covariance
// C = I + N N', parameters the covariance (P' C^-1 P + priors)^-1, and the estimator's gain
// A = -cov P' C^-1 takes it apart exactly: A A' of the data, (A N_k)(A N_k)' of each nuisance (the
// budget's rows, and by how much a parameter changes with it). Segments that a scene gives to its
// members move the estimate by A times 4/3 of what twice as many change (Richardson, second order).
//
// Where the probability of chi-square is below 5 % the model has an error tau of its own in every
// frequency (line of an FRF), by Paule and Mandel's estimate, chi2(tau) = degrees of freedom;
// errors that states of a mode or modes of a state share widen by the clustered covariance
//   B (sum_g s_g s_g') B G / (G - 1),  B = (J' J)^-1,  s_g = J_g' r_g
// of G groups. Sources: GUM (JCGM 100:2008) 5; Paule and Mandel, J. Res. NBS 87 (1982) 377; Liang
// and Zeger, Biometrika 73 (1986) 13. For the update and its checks, not for users.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/update/likelihood.h"

namespace rigfit::ident {

/// Probability below which stated uncertainties do not explain a misfit.
inline constexpr double kUnlikelyMisfit = 0.05;

/// Chi-square at q without any error of the model, its probability.
[[nodiscard]] UpdateFit misfit_of(const Likelihood& likelihood,
                                  const std::vector<UpdateMatch>& matches,
                                  const Eigen::VectorXd& q);

/// tau of the frequencies, or where there are FRFs of their lines; 0: none is needed.
[[nodiscard]] double model_std_of(const Likelihood& likelihood,
                                  const std::vector<UpdateMatch>& matches,
                                  const Eigen::VectorXd& q);

/// Square roots of the weights that Huber's loss gives to residuals; priors have 1.
[[nodiscard]] Eigen::VectorXd huber_weights(const Likelihood& likelihood, const Eigen::VectorXd& r);

/// States parameters' uncertainties with their sources, what is open, and the pairs' model
/// uncertainties at `result.coordinates`. `by_segments`: what segments move the coordinates by,
/// where that is known; empty: as above.
void state_uncertainty(const Likelihood& likelihood, const std::vector<UpdateMatch>& matches,
                       UpdateResult& result, const Eigen::VectorXd& by_segments = {});

/// What the cost says of all coordinates: as `UpdateResult::joint` without segments.
[[nodiscard]] Identifiability knowledge_by_cost(const Likelihood& likelihood,
                                                const std::vector<UpdateMatch>& matches,
                                                const UpdateResult& result);

/// Standard uncertainties of the model's frequencies of these pairs at q, and what they are of a
/// state that was held out.
void state_prediction_uncertainty(const Likelihood& likelihood, const UpdateResult& result,
                                  const Eigen::VectorXd& q, int held_out,
                                  std::vector<UpdatedPair>& pairs);

}  // namespace rigfit::ident
