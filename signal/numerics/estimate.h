// A value with its standard uncertainty, and an interval, in the unit that the owning field's name
// states.
#pragma once

#include <limits>

namespace rigfit::signal {

/// A value with its standard uncertainty.
struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double std = std::numeric_limits<double>::quiet_NaN();  ///< standard uncertainty (GUM, k = 1)
};

/// An interval of values.
struct Interval {
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace rigfit::signal
