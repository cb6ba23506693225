// Location and scatter that a few wild samples do not move.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace rigfit::signal {

/// Middle value (mean of the two for an even number); 0 of nothing.
[[nodiscard]] inline double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

/// 1.4826 times the median absolute deviation: the standard deviation of Gaussian noise.
[[nodiscard]] inline double robust_std(std::vector<double> values, double centre) {
  for (double& value : values) value = std::abs(value - centre);
  return 1.4826 * median(std::move(values));
}

}  // namespace rigfit::signal
