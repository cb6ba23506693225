#include "ident/statistics/root.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>

#include <limits>
#include <memory>

namespace rigfit::ident {

double root_between(double low, double high, double tolerance,
                    const std::function<double(double)>& f) {
  const double at_low = f(low), at_high = f(high);
  if (at_low == 0) return low;
  if (at_high == 0) return high;
  if (!(at_low > 0 ? at_high < 0 : at_low < 0 && at_high > 0)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  gsl_function function{[](double x, void* of) {
                          return (*static_cast<const std::function<double(double)>*>(of))(x);
                        },
                        const_cast<std::function<double(double)>*>(&f)};
  const std::unique_ptr<gsl_root_fsolver, void (*)(gsl_root_fsolver*)> brent(
      gsl_root_fsolver_alloc(gsl_root_fsolver_brent), gsl_root_fsolver_free);
  gsl_root_fsolver_set(brent.get(), &function, low, high);
  for (int i = 0; i < 200; ++i) {
    if (gsl_root_fsolver_iterate(brent.get()) != GSL_SUCCESS) break;
    if (gsl_root_test_interval(gsl_root_fsolver_x_lower(brent.get()),
                               gsl_root_fsolver_x_upper(brent.get()), 0,
                               tolerance) == GSL_SUCCESS) {
      break;
    }
  }
  return gsl_root_fsolver_root(brent.get());
}

}  // namespace rigfit::ident
