// What is done about the number of segments in an update.
//
// Members with given segments are that model: its parameters are fitted. Where all members leave
// them to the program ("auto") the scene stands for the rig itself. Small as the error of 30
// segments is, it is a large part of what a weakly acting parameter does (bending in a taut cable:
// 3.6 % of EI). The model's own frequencies for vanishing segments
// (model/linear/segment_extrapolation.h), found at the parameters and held, give the error of the
// chain, which is taken off wherever that chain is asked; twice over, as the parameters move.
// FRFs get 2, 4 or 8 times the segments. Internal to the update and its checks.
#pragma once

#include <Eigen/Core>

#include "ident/update/problem/update_solver.h"

namespace rigfit::ident {

/// `problem` with the segments' error taken off its modes at the answer, and the answer moved to
/// its minimum, pairs kept. Returns `problem` unchanged where no minimum is found then.
[[nodiscard]] UpdateProblem take_segments_off(const UpdateProblem& problem,
                                              const UpdateOptions& options, UpdateSolution& answer);

/// `problem` with so many segments of its "auto" members that twice as many change its residuals at
/// q by a third of their standard deviation, all together: no parameter by more of its own.
[[nodiscard]] UpdateProblem with_resolving_segments(const UpdateProblem& problem,
                                                    const std::vector<UpdateMatch>& matches,
                                                    const Eigen::VectorXd& q);

/// The problem as the solution was found in it: what is known to an uncertainty, its segments,
/// their error taken off at `q`.
[[nodiscard]] UpdateProblem as_solved(const UpdateProblem& problem, const UpdateOptions& options,
                                      const UpdateResult& solution, const Eigen::VectorXd& q);

}  // namespace rigfit::ident
