// A value with its standard uncertainty, in the unit that the owning field's name states.
#pragma once

#include <limits>

namespace rigfit::signal {

struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double std = std::numeric_limits<double>::quiet_NaN();  ///< standard uncertainty (GUM, k = 1)
};

}  // namespace rigfit::signal
