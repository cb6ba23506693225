// Means of a spectrum over neighbouring lines.
#pragma once

#include <Eigen/Core>

namespace rigfit::signal {

/// Mean over lines k - half .. k + half of each line k, over fewer at the ends, never below 0: what
/// rounding makes of a mean of powers that are 0.
[[nodiscard]] Eigen::ArrayXd mean_over_lines(const Eigen::Ref<const Eigen::ArrayXd>& powers,
                                             Eigen::Index half);

}  // namespace rigfit::signal
