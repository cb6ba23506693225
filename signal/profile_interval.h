// Intervals of a damped sinusoid's decay rate and frequency from the likelihood itself.
//
// The interval holds the values theta for which the best fit with theta held leaves
//   RSS(theta) <= RSS_min (1 + k^2 / degrees),
// k the Student factor of the level asked for. Where the fit is as good as linear this is value +-
// k std; in noise, where it is not, it is wider and lopsided as the likelihood is. Source: Bates,
// Watts, Nonlinear Regression Analysis and Its Applications (1988), ch. 6.
#pragma once

#include <Eigen/Core>
#include <span>

#include "signal/damped_sinusoids.h"

namespace rigfit::signal {

struct ProfileInterval {
  /// Distances from the fit's value, over those of a linear fit (k std): 1 where it is linear.
  double below = 1, above = 1;
  bool bounded = true;  ///< false: a side was cut at four times the linear distance
};

/// `part`: 2 m the real, 2 m + 1 the imaginary part of pole m of `fit` to `y` (missing samples 0).
/// `std`: of that part; in coloured noise it scales the rise of the sum of squares that is allowed.
/// `factor`: k.
[[nodiscard]] ProfileInterval profile_interval(const Eigen::Ref<const Eigen::VectorXd>& y,
                                               std::span<const Eigen::Index> missing,
                                               const DampedSinusoidsFit& fit, Eigen::Index part,
                                               double std, double factor);

}  // namespace rigfit::signal
