// What every test includes: GoogleTest with its matchers, the standard headers of numerical code,
// comparisons of matrices and of codes.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/expect_matrix.h"
#include "tests/findings.h"
#include "tests/normal.h"

namespace rigfit {
using Complex = std::complex<double>;
using Eigen::Index;
inline constexpr double kPi = std::numbers::pi;
inline constexpr double kInf = std::numeric_limits<double>::infinity();
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MatricesNear;
using testing::Normal;
using ::testing::Not;
using testing::says;
using ::testing::UnorderedElementsAre;

/// Whether the truth lies between the `low` and `high` of an interval.
template <typename Interval>
::testing::AssertionResult holds(const Interval& interval, double truth) {
  const bool inside = interval.low <= truth && truth <= interval.high;
  return (inside ? ::testing::AssertionSuccess() : ::testing::AssertionFailure())
         << truth << ": " << interval.low << " to " << interval.high;
}
}  // namespace rigfit
