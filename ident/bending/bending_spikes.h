// Rows of a load-deflection record that hold a spike: one or two samples far off their neighbours,
// or in a short table far off the line of load over deflection. Inside of bending_analysis.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace rigfit::ident {

/// Samples of one channel (20 at least, else none) that lie off the mean of their neighbours and
/// off the straight lines through the two samples before and after, all three, by more than 12
/// robust standard deviations of that and by a twentieth of the channel's central range. A turn is
/// on one of the two lines, a step too.
[[nodiscard]] std::vector<Eigen::Index> find_spikes(const Eigen::VectorXd& channel);

/// Rows of a table whose load lies off the line by the median of all slopes between two rows (Theil
/// and Sen) by more than half the load's range and 10 robust standard deviations. Five rows at
/// least, else none.
[[nodiscard]] std::vector<Eigen::Index> find_table_spikes(const Eigen::VectorXd& deflection,
                                                          const Eigen::VectorXd& load);

}  // namespace rigfit::ident
