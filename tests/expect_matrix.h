// One comparison of matrices for every test: sizes, NaN, and the worst entry with its index.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

namespace rigfit::testing {

/// Passes when both have the same size, no NaN, and |a - b| <= tolerance everywhere.
template <typename A, typename B>
::testing::AssertionResult MatricesNear(const Eigen::MatrixBase<A>& a,
                                        const Eigen::MatrixBase<B>& b, double tolerance) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) {
    return ::testing::AssertionFailure() << "sizes differ: " << a.rows() << " x " << a.cols()
                                         << " and " << b.rows() << " x " << b.cols();
  }
  double worst = -1;
  Eigen::Index row = 0, col = 0;
  for (Eigen::Index j = 0; j < a.cols(); ++j) {
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      const double difference = std::abs(a(i, j) - b(i, j));
      if (!(difference <= worst)) {
        worst = difference, row = i, col = j;
        if (std::isnan(difference)) {
          return ::testing::AssertionFailure() << "NaN at (" << i << ", " << j << ")";
        }
      }
    }
  }
  if (worst <= tolerance) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure()
         << "worst at (" << row << ", " << col << "): " << a(row, col) << " and " << b(row, col)
         << " differ by " << worst << ", more than " << tolerance;
}

}  // namespace rigfit::testing
