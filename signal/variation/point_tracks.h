// One mode over all points of a test: which poles of the points belong together, the mode's value
// with the uncertainty of its mean, the scatter between points and the trend along their order.
//
// Linking: nearest pairs first; two poles of one point are never linked, so a close pair counts as
// two modes only where the same points show both. Poles are linked when their bandwidths touch
// (|p - q| below the sum of the half bandwidths) or, where both stand clear of their surroundings,
// when they lie within 20 half-power bandwidths and 2 % of each other and have like damping: a mode
// that drifts.
//
// Mean: random effects, p_c = mean + d_c + e_c with var e_c known and var d_c = tau^2 from the
// scatter (Paule, Mandel, J. Res. NBS 87 (1982) 377); the mean's variance from the weighted scatter
// itself (Hartung, Knapp, Stat. Med. 20 (2001) 3875), widened by Student's t for the number of
// points so that +-1.96 std hold 95 %. Where the value changes along the order of the points with a
// chance below 1 %, the scatter is that about the straight line, and the mean the line's middle.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "signal/numerics/estimate.h"
#include "signal/variation/point_poles.h"

namespace rigfit::signal {

/// Poles of different points that are one mode, by point; at most one a point.
[[nodiscard]] std::vector<std::vector<PointPole>> link_points(const ModalBand& band,
                                                              std::vector<PointPole> poles);

struct MeanOverPoints {
  Estimate value;          ///< mean over the points
  double between_std = 0;  ///< tau: scatter between points beyond their own errors, trend included
  Estimate trend;          ///< change from one point to the next
  bool has_trend = false;  ///< chance below 1 %
  double excess_chance = 1;  ///< that points which are equal differ as much
};

struct LineOverPoints {
  Estimate level;     ///< at x = 0; +-1.96 std hold 95 %
  Estimate slope;     ///< std without Student's t
  double chance = 1;  ///< probability of a slope as steep where there is none
};

/// value = level + slope x + random scatter + own error, at four points or more.
[[nodiscard]] LineOverPoints line_over_points(const Eigen::Ref<const Eigen::VectorXd>& value,
                                              const Eigen::Ref<const Eigen::VectorXd>& std,
                                              const Eigen::Ref<const Eigen::VectorXd>& x);

/// `order`: of the points, rising with time; `points`: number of all points, whose middle is the
/// mean rig. One value: itself.
[[nodiscard]] MeanOverPoints mean_over_points(const Eigen::Ref<const Eigen::VectorXd>& value,
                                              const Eigen::Ref<const Eigen::VectorXd>& std,
                                              const Eigen::Ref<const Eigen::VectorXd>& order,
                                              Eigen::Index points);

}  // namespace rigfit::signal
