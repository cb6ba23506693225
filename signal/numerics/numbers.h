// Numbers that many sources need by name.
#pragma once

#include <limits>
#include <numbers>

namespace rigfit::signal {

inline constexpr double kTwoPi = 2 * std::numbers::pi;
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();  ///< not known

}  // namespace rigfit::signal
