#pragma once

#include <functional>

namespace rigfit::ident {

/// Root of `f` between two values where its signs differ, by Brent's method (GSL) until the bracket
/// is `tolerance` of its own lower end wide; NaN where the signs are the same.
[[nodiscard]] double root_between(double low, double high, double tolerance,
                                  const std::function<double(double)>& f);

}  // namespace rigfit::ident
