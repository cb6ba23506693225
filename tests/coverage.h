// How often stated intervals hold the truth, and the mean error over the stated std.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rigfit::testing {

class Coverage {
 public:
  explicit Coverage(double stated = 0.95) : stated_(stated) {}

  void add(double value, double std, double low, double high, double truth) {
    ++trials_;
    finite_ = finite_ && std::isfinite(value + low + high) && std > 0;
    covered_ += low <= truth && truth <= high;
    sum_ += (value - truth) / std;
  }
  /// An estimate with the interval of its normal distribution.
  void add(double value, double std, double truth) {
    add(value, std, value - 1.96 * std, value + 1.96 * std, truth);
  }
  [[nodiscard]] int trials() const { return trials_; }

  /// The share is above the stated one less three binomial deviations, the mean error below three
  /// of its own (three over the root of the number of trials) or below `bias`.
  [[nodiscard]] ::testing::AssertionResult holds(double bias = 0.1) const {
    const double n = trials_, share = covered_ / n, mean = sum_ / n;
    const double least = stated_ - 3 * std::sqrt(stated_ * (1 - stated_) / n);
    const double most = std::max(bias, 3 / std::sqrt(n));
    const bool held = finite_ && share >= least && std::abs(mean) <= most;
    return (held ? ::testing::AssertionSuccess() : ::testing::AssertionFailure())
           << 100 * share << " % of " << trials_ << ", at least " << 100 * least << "; bias "
           << mean << " std, at most " << most << (finite_ ? "" : "; not finite");
  }

 private:
  double stated_;
  int trials_ = 0, covered_ = 0;
  double sum_ = 0;
  bool finite_ = true;
};

}  // namespace rigfit::testing
