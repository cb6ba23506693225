// Correlations of signals with linear combinations of them, by groups of the recording.
//
//   R_g(k) = 1 / N(k) sum over t in group g of y(t + k) x(t)^T,   -L <= k <= L,   x = F^T y
//
// with N(k) the number of products of all groups. A product belongs to the group of t, and y is
// read over the group's edges: the groups add up to the mean over the recording exactly, which has
// no bias of a window or of leakage. Missing samples are missing products, which N(k) does not
// count. Computed by transforms of segments, whose cross-spectra are added up before they go back
// to lags.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "signal/ambient/ambient_signals.h"

namespace rigfit::signal {

struct GroupOptions {
  int groups = 1;
  int threads = 1;
};

/// `receive` gets R_g of all channels with the `filters` (channels x signals) for every group in
/// turn: (2 L + 1) x (channels signals), column signal * channels + channel.
void group_correlations(const AmbientSignals& signals, const Eigen::MatrixXd& filters,
                        Eigen::Index lags, const GroupOptions& options,
                        const std::function<void(int group, const Eigen::MatrixXd& R)>& receive);

}  // namespace rigfit::signal
