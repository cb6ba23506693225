// The answer of a fit to FRFs: with what lines share, and with segments that resolve them
// (formulas in shared_sources.h, update_misfit.h and update_segments.h). For the update, not for
// users.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "ident/update/problem/update_solver.h"

namespace rigfit::ident {

/// Fits of FRFs: moves `answer` to the minimum with the inputs that lines share, then, where the
/// misfit asks for it, with an error of the model in every line (`result.fit`). `settled` becomes
/// the problem of that minimum. Nothing without FRFs.
void allow_for_shared(const UpdateOptions& options, UpdateProblem& settled, UpdateSolution& answer,
                      UpdateResult& result);

/// A fit with more segments than its scenes give.
struct ResolvedFit {
  UpdateProblem problem;
  UpdateSolution answer;
  UpdateFit fit;                ///< as allow_for_shared leaves it
  Eigen::VectorXd by_segments;  ///< the answer as given less this one, and what is left
};

/// Of FRFs of members whose segments are given and do not resolve them; `result` is stated with
/// `settled`. None: nothing to be gained.
[[nodiscard]] std::optional<ResolvedFit> with_resolving_segments(const UpdateProblem& settled,
                                                                 const UpdateOptions& options,
                                                                 const UpdateSolution& answer,
                                                                 UpdateResult result);

}  // namespace rigfit::ident
