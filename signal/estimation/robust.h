// Location and scatter that are insensitive to a few outliers (GSL's order statistics).
#pragma once

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

/// Those that are numbers.
[[nodiscard]] std::vector<double> finite_values(const Ref<const VectorXd>& values);

/// Middle value (mean of the two for an even number); 0 for no values.
[[nodiscard]] double median(std::vector<double> values);

/// Value below which `share` (0..1) of the values lie, linear between them; 0 for no values.
[[nodiscard]] double quantile(std::vector<double> values, double share);

/// 1.4826 times the median absolute deviation: the standard deviation of Gaussian noise.
[[nodiscard]] double robust_std(std::vector<double> values, double centre);

}  // namespace rigfit::signal
