// A root of a continuous function between two points where its sign differs: Brent's method.
#pragma once

#include <gsl/gsl_roots.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace rigfit::model {

/// f(low) and f(high) must not have the same sign (either may be zero). To the last bit or two.
template <typename Function>
[[nodiscard]] double bracketed_root(Function f, double low, double high) {
  if (f(low) == 0) return low;
  if (f(high) == 0) return high;
  gsl_function call{[](double x, void* self) { return (*static_cast<Function*>(self))(x); }, &f};
  const std::unique_ptr<gsl_root_fsolver, void (*)(gsl_root_fsolver*)> solver(
      gsl_root_fsolver_alloc(gsl_root_fsolver_brent), gsl_root_fsolver_free);
  gsl_root_fsolver_set(solver.get(), &call, std::min(low, high), std::max(low, high));
  for (int k = 0; k < 200; ++k) {
    gsl_root_fsolver_iterate(solver.get());
    const double x = gsl_root_fsolver_root(solver.get());
    const double width = std::abs(solver->x_upper - solver->x_lower);
    if (width <= 4 * std::numeric_limits<double>::epsilon() * std::abs(x) || f(x) == 0) break;
  }
  return gsl_root_fsolver_root(solver.get());
}

}  // namespace rigfit::model
