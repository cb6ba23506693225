// What the number of segments does to a fit: a bridge until the model gives derivatives of
// frequencies at an asked accuracy.
//
// Members that leave their segments to the program stand for the rig itself: at the answer the
// model gives its frequencies to a twentieth of the best standard uncertainty (it extrapolates over
// segments itself), their ratio to those of the fit's segments is held, and the fit repeated. FRFs
// are fitted as segments give them: the fit is repeated with 2, 4 and 8 times as many until what is
// left is below a fifth of the parameters' uncertainty and of chi-square's standard deviation; the
// finest has the verdict. Given segments keep their own parameters, and what the finer ones changed
// is part of the uncertainty. For the update, not for users.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "ident/update/fit.h"

namespace rigfit::ident {

inline constexpr double kOfHalving = 4.0 / 3;  ///< error of n over f(n) - f(2 n), second order

/// Whether a member of that state (-1: of any) has segments of its own.
[[nodiscard]] bool has_given_segments(const Likelihood& likelihood, int state);

/// Residuals of this model less those of vanishing segments, where scenes give segments and in
/// FRFs. False where there is no model of twice as many.
[[nodiscard]] bool change_by_segments(const Likelihood& likelihood,
                                      const std::vector<UpdateMatch>& matches,
                                      const Eigen::VectorXd& q, Eigen::VectorXd& change);

/// Takes the error of "auto" segments off the frequencies that count as data, and moves the answer
/// to its minimum, pairs kept; `passes`: again where this leads to.
void take_segments_off(Likelihood& likelihood, UpdateSolution& answer, int passes = 2);

/// How many times too large the segments' part of a stated result is, as a ratio of h^2.
[[nodiscard]] double segment_excess(const Likelihood& likelihood,
                                    const std::vector<UpdateMatch>& matches,
                                    const UpdateResult& result);

}  // namespace rigfit::ident
