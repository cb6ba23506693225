// What every test includes: GoogleTest with its matchers, the standard headers of numerical code,
// comparisons of matrices and of codes.
#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/normal.h"

namespace rigfit::testing {

/// Whether one of a list of notes or findings has a code.
template <typename List>
bool says(const List& list, std::string_view code) {
  return std::any_of(list.begin(), list.end(), [&](const auto& one) { return one.code == code; });
}

/// How often a text has another.
inline std::size_t count(std::string_view text, std::string_view what) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string_view::npos; ++at) ++n;
  return n;
}

/// Passes when both have the same size, no NaN, and |a - b| <= tolerance everywhere.
template <typename A, typename B>
::testing::AssertionResult MatricesNear(const Eigen::MatrixBase<A>& a,
                                        const Eigen::MatrixBase<B>& b, double tolerance) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) {
    return ::testing::AssertionFailure() << "sizes differ: " << a.rows() << " x " << a.cols()
                                         << " and " << b.rows() << " x " << b.cols();
  }
  // NaN is not near to anything.
  if (((a - b).array().abs() <= tolerance).all()) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << a << "\nand\n"
                                       << b << "\ndiffer by more than " << tolerance;
}

}  // namespace rigfit::testing

namespace rigfit {
using Complex = std::complex<double>;
using Eigen::Index;
inline constexpr double kPi = std::numbers::pi;
inline constexpr double kInf = std::numeric_limits<double>::infinity();
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

using ::testing::AllOf;
using ::testing::Contains;
using testing::count;
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
