// Correlations of signals with linear combinations of them, by groups of the recording.
//
//   R_g(k) = sum over t in group g of y(t + k) x(t)^T,   -L <= k <= L,   x = F^T y
//
// A product belongs to the group of t, and y is read over the group's edges: the groups add up to
// the recording exactly, and sum R_g / sum n_g has no bias of a window or of leakage. Missing
// samples are missing products, which n_g(k) does not count. Computed by transforms of segments,
// whose cross-spectra are added up before they go back to lags.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <utility>
#include <vector>

#include "signal/ambient/ambient_signals.h"

namespace rigfit::signal {

class GroupCorrelations {
 public:
  /// `share`: part of each group's samples that is used, from its beginning (0..1].
  GroupCorrelations(const AmbientSignals& signals, Eigen::Index lags, int groups, double share,
                    int threads);

  [[nodiscard]] Eigen::Index lags() const { return lags_; }
  [[nodiscard]] int groups() const { return static_cast<int>(ranges_.size()); }
  /// n_g(k): (2 L + 1) x groups.
  [[nodiscard]] const Eigen::MatrixXd& counts() const { return counts_; }

  /// R_g of all channels with the `filters` (channels x signals): (2 L + 1) x (channels signals),
  /// column signal * channels + channel. `receive` is called for every group in turn.
  void each(const Eigen::MatrixXd& filters,
            const std::function<void(int group, const Eigen::MatrixXd& R)>& receive) const;
  /// Sum over groups of all channels with each other, over the number of products.
  [[nodiscard]] Eigen::MatrixXd all_pairs() const;

 private:
  const AmbientSignals& signals_;
  Eigen::Index lags_;
  int threads_;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> ranges_;
  Eigen::MatrixXd counts_;
};

}  // namespace rigfit::signal
