// Which mode of one chain is which of another: by their shapes, whatever segments the two have.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/linear/modes.h"

namespace rigfit::model {

/// Displacements of a motion's modes at `samples` evenly spaced places of each member, columns of
/// unit length (zero where nothing but twist moves).
[[nodiscard]] Eigen::MatrixXd sampled_shapes(const ChainModes& modes, const MotionModes& motion,
                                             const std::vector<int>& samples);

/// The mode of `after` that each of `before` is, columns as of `sampled_shapes`: by shape, then by
/// order and frequency (squares in (rad/s)^2); -1: none.
[[nodiscard]] std::vector<int> following_modes(const Eigen::MatrixXd& before,
                                               const Eigen::MatrixXd& after,
                                               const Eigen::VectorXd& omega2_before,
                                               const Eigen::VectorXd& omega2_after);

}  // namespace rigfit::model
