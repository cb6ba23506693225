// 95 % intervals of an update's parameters.
//
// Linear in the fitted coordinate, q +- k std, where the cost is a parabola as far as that. It is
// not where the deviance at the linear ends, with all others moved along, is off k^2 by more than a
// quarter, or where any parameter lies within its interval of a bound: then the interval is that of
// the profile, where the least cost with the parameter held, all others fitted anew, exceeds the
// least by k^2 / 2. A parameter that the data cannot tell may still be bounded to one side. Where
// there are several answers the interval is that of the mixture of all, by their weights. Source:
// Bates and Watts, Nonlinear Regression Analysis and its Applications, 1988, 6.1.2. For the update
// and its checks, not for users.
#pragma once

#include <vector>

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

/// low, high and interval_by_profile of the result's parameters.
void state_intervals(const UpdateProblem& problem, const UpdateOptions& options,
                     const std::vector<UpdateMatch>& matches, UpdateResult& result);

/// low and high of the result's parameters, over its alternatives.
void state_mixture(UpdateResult& result);

}  // namespace rigfit::ident
