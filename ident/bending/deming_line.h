// A straight line through points with errors in both coordinates, robust against outliers.
//
//   minimise sum_i w_i (y_i - c - k x_i)^2 / (sigma_y^2 + k^2 sigma_x^2)
//
// Deming's closed form for given weights, Huber's weights by iteration (1.345 standard deviations
// in perpendicular distance, scale from the median absolute deviation).
// Sources: Deming 1943; Fuller, Measurement Error Models, 1.3; Huber, Robust Statistics.
#pragma once

#include <Eigen/Core>

namespace rigfit::ident {

struct DemingLine {
  double slope = 0, offset = 0;
  double slope_std = 0;           ///< the larger of textbook and block jackknife
  double degrees_of_freedom = 0;  ///< for slope_std
  double residual_rms = 0;        ///< weighted rms of the residuals in y
  double curvature = 0;           ///< change of slope over the range of x, relative to the slope
  double curvature_std = 0;       ///< by block jackknife (textbook for few points)
  bool usable = false;            ///< four points at least, x not constant
};

/// `noise_x`, `noise_y`: standard deviations; only their ratio matters. Both zero: equal in
/// relation to the ranges. Points in the order they were taken (the jackknife's blocks are
/// contiguous).
[[nodiscard]] DemingLine fit_deming_line(const Eigen::Ref<const Eigen::VectorXd>& x,
                                         const Eigen::Ref<const Eigen::VectorXd>& y, double noise_x,
                                         double noise_y, bool uncertainty = true);

}  // namespace rigfit::ident
