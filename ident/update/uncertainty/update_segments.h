// What the number of segments does to an update, and what is done about it.
//
// Small as the error of the segments is, it is a large part of what a weakly acting parameter does
// (bending in a taut cable: 3.6 % of EI with 30 segments). A person who gives the members of a
// scene their segments gets the parameters of that model, with what its segments do to them
// (Richardson's formula) in their uncertainty. Where all members leave them to the program ("auto")
// the scene stands for the rig itself: the model's own frequencies for vanishing segments
// (model/linear/segment_extrapolation.h), found at the parameters and held, give the error of a
// chain, which is taken off wherever that chain is asked; twice over, as the parameters move.
//
// Fits of FRFs are repeated with 2, 4 and 8 times the segments until their error is below a fifth
// of every parameter's uncertainty by all else and of chi-square's standard deviation. For "auto"
// members that fit is the answer. Where segments are given, it gives the verdict and the
// covariance, and the change of the parameters by the given segments, with the error that remains,
// is part of their uncertainty: an error that shifts a resonance by part of its width is not linear
// in h^2, so that no linear estimate covers it. Internal to the update and its checks.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "ident/update/problem/update_solver.h"

namespace rigfit::ident {

/// `problem` with the segments' error taken off its modes at the answer, and the answer moved to
/// its minimum, pairs kept; `passes` repeats this at the parameters found. Returns `problem`
/// unchanged where no minimum is found then.
[[nodiscard]] UpdateProblem take_segments_off(const UpdateProblem& problem,
                                              const UpdateOptions& options, UpdateSolution& answer,
                                              int passes = 2);

/// A fit to FRFs with more segments than at first.
struct ResolvedFit {
  UpdateProblem problem;
  UpdateSolution answer;
  UpdateFit fit;                ///< as settle_frfs leaves it
  Eigen::VectorXd by_segments;  ///< the answer of the segments at first less this one, and the rest
};

/// Of FRFs that their segments do not resolve; `result` is stated with `settled`. None: nothing to
/// be gained.
[[nodiscard]] std::optional<ResolvedFit> with_resolving_segments(const UpdateProblem& settled,
                                                                 const UpdateOptions& options,
                                                                 const UpdateSolution& answer,
                                                                 UpdateResult result);

/// The problem as the solution was found in it: what is known to an uncertainty, its segments,
/// their error taken off at `q`.
[[nodiscard]] UpdateProblem as_solved(const UpdateProblem& problem, const UpdateOptions& options,
                                      const UpdateResult& solution, const Eigen::VectorXd& q);

}  // namespace rigfit::ident
