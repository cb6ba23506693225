// What the number of segments does to an update, and what is done about it.
//
// A modelled frequency errs by a h^2 + b h^4 + ... in the segments' length h. Small as that is, it
// is a large part of what a weakly acting parameter does (bending in a taut cable: 3.6 % of EI with
// 30 segments). A person who gives a member its segments gets the parameters of that model, with
// what its segments do to them (Richardson's formula) in their uncertainty. Members that leave them
// to the program ("auto") stand for the rig itself: frequencies that are data have the error of
// their segments taken off. From n, 2 n and 4 n segments Romberg's table gives ln f for h -> 0; its
// difference to ln f of n, found at the parameters and held, is subtracted wherever the model with
// n segments is asked, twice over as the parameters move. What Romberg's last column changed stays
// as the uncertainty. FRFs are fitted as n segments give them.
//
// "auto" gets more segments until what is left is below a fifth of every parameter's uncertainty by
// all else, below a fifth of chi-square's standard deviation in the residuals of FRFs, and below
// the scene's accuracy in the frequencies, at most eight times as many as at first. FRFs of members
// whose segments are given: the fit is repeated with 2, 4 and 8 times as many until they meet the
// same limits. That fit gives the verdict and the covariance. The change of the parameters by the
// given segments, with the error that remains, is their uncertainty. An error that shifts a
// resonance by part of its width is not linear in h^2, so that no linear estimate covers it.
// Source: Stoer and Bulirsch, Introduction to Numerical Analysis, 3.4. Internal to the update and
// its checks.
#pragma once

#include "ident/update/problem/update_solver.h"

namespace rigfit::ident {

/// `problem` with the segments' error taken off at the answer, and the answer moved to its minimum,
/// pairs kept; `passes` repeats this at the parameters found. Returns `problem` unchanged where
/// nothing is to be taken off, or where no minimum is found then.
[[nodiscard]] UpdateProblem take_segments_off(const UpdateProblem& problem,
                                              const UpdateOptions& options, UpdateSolution& answer,
                                              int passes = 2);

/// How many times too large the segments' error is, as a ratio of h^2; `result`: stated with
/// `problem`.
[[nodiscard]] double segment_excess(const UpdateProblem& problem,
                                    const std::vector<UpdateMatch>& matches,
                                    const UpdateResult& result);

/// Segments that "auto" needs: `now` when these are enough or cannot be more.
[[nodiscard]] int auto_segments_needed(const UpdateProblem& problem, const UpdateOptions& options,
                                       const std::vector<UpdateMatch>& matches,
                                       const UpdateResult& result, int now);

/// The problem as the solution was found in it: its segments, their error taken off at `q`.
[[nodiscard]] UpdateProblem as_solved(const UpdateProblem& problem, const UpdateOptions& options,
                                      const UpdateResult& solution, const Eigen::VectorXd& q);

}  // namespace rigfit::ident
