// Numbers, vectors and matrices by their short names, with the standard headers that nearly every
// numerical source needs.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace rigfit::signal {

using Complex = std::complex<double>;
using Eigen::ArrayXcd, Eigen::ArrayXd, Eigen::ArrayXXcd, Eigen::ArrayXXd, Eigen::Index, Eigen::Map,
    Eigen::MatrixXcd, Eigen::MatrixXd, Eigen::Ref, Eigen::VectorXcd, Eigen::VectorXd;

inline constexpr double kTwoPi = 2 * std::numbers::pi;
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();  ///< not known

/// A value with its standard uncertainty, in the unit that the owning field's name states.
struct Estimate {
  double value = kNaN;
  double std = kNaN;  ///< standard uncertainty (GUM, k = 1)
};

/// An interval of values.
struct Interval {
  double low = kNaN;
  double high = kNaN;
};

}  // namespace rigfit::signal
