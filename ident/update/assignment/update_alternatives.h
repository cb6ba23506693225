// All answers of a fit to modes that the data support, from the whole range of the parameters.
//
// An answer is an assignment of measured to modelled modes that is the most likely one
// (mode_assignment.h) at the parameters that fit it best. Candidates come from points all over the
// range of the parameters (a lattice of absolute places in one and two dimensions, a
// low-discrepancy sequence in more; positive parameters up to a factor of 100 or 10 from their
// start), where the model is assigned, as it is and with all frequencies of a state times a factor
// of up to 2 either way, in steps of two standard deviations of 5 %: tension and mass move them
// alike, and neighbouring places are up to 1.8 apart in frequency, beyond some six
// standard deviations within which modes pair. The best are fitted. The weight of an answer is its
// evidence
//
//   Z = sum_tau P(tau) L(q, tau) prior(q) (2 pi)^(n/2) det(H(tau))^(-1/2)      (Laplace)
//
// with tau the model's relative error in frequency: 0 (the model is right) with probability 1/2,
// else 1e-4 to 0.1 on a logarithmic scale, L the likelihood of the assignment (a mode without a
// partner has its damping ratio anywhere within a factor of 100), H the Hessian of -ln(L prior).
// Damping ratios err ten times as much; known to 1e-4 they would otherwise lead the search.
// Parameters without a prior get a normal one about the answer, of ln(10) in ln(value) and of a
// tenth for coordinates: the same for all answers, wherever the search began; while looking for one
// it is about the place where the search began, so that what the data leave free stays there.
// Answers closer to each other than three standard deviations are one. Each answer is fitted again
// with the positive parameters of two owners (nodes, members) or two axes exchanged, quantity by
// quantity: frequencies may not tell which end has which spring, or which plane which EI.
//
// The search is skipped where the answer near the start explains the measured modes and could not
// do so by chance: the degrees of freedom times ln(0.1 / error), less the ln(likelihood) that
// missed and false modes cost, exceed 12. A false mode that such an answer pairs is left out all
// the same where the evidence rises without it: its error becomes the model's, of all modes.
// Without damping ratios that is tried only where the misfit that it takes off, n / 2 ln of the
// ratio of chi-squares over n pairs, is more than a false mode costs.
//
// Sources: Kass and Raftery, JASA 90 (1995) 773; Beck and Katafygiotis, J. Eng. Mech. 124 (1998)
// 455. For the update and its checks, not for users.
#pragma once

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

/// ln of the ratio of weights from which on the lighter answer counts as impossible: 0.001.
inline constexpr double kNegligible = 7;

/// Evidence, error and Hessian of an answer at its solution, such as one whose problem has the
/// error of its segments taken off since; false where there is no model.
[[nodiscard]] bool weigh(const UpdateProblem& problem, UpdateAnswer& answer);

/// Without weights; empty: no start led to a model, `failure` says why.
/// `fits` counts the local fits. For problems of modes alone.
[[nodiscard]] std::vector<UpdateAnswer> find_answers(const UpdateProblem& problem, int& fits,
                                                     std::string& failure);

}  // namespace rigfit::ident
