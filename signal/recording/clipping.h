// Clipping seen in the samples themselves: flat tops at a channel's extremes, below the nominal
// range too.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace rigfit::signal {

/// What a whole channel tells about where it may be clipped.
struct ClipLevels {
  double low = 0, high = 0;  ///< extremes of the finite samples
  double step = 0;           ///< smallest change between neighbours: the quantisation, if any
};
[[nodiscard]] ClipLevels clip_levels(const Eigen::Ref<const Eigen::VectorXd>& channel);

/// True when samples first..last (inclusive) reach the nominal range (0: not known), or stay at an
/// extreme of the channel for three samples or more and come there by a step that quantisation does
/// not explain: the top of a smooth signal quantised in steps q that stays equal over n >= 3
/// samples is a parabola that falls by q at most over n / 2 samples, so it leaves them by less than
/// 3 q. Two samples that are equal there are clipped when they are left by more than 100 q: the
/// slope of a top as sharp puts them within a quantum of each other once in a hundred records.
/// `rest` is the channel's value at rest; a level within 10 % of the span of it is no clipping.
[[nodiscard]] bool is_clipped(const Eigen::Ref<const Eigen::VectorXd>& channel,
                              const ClipLevels& levels, double rest, Eigen::Index first,
                              Eigen::Index last, double nominal_range = 0);

/// The samples of a channel that are clipped.
struct ClippedSamples {
  std::vector<bool> at;        ///< by sample
  long count = 0;              ///< number of clipped samples
  Eigen::Index first = -1;     ///< -1: none
  std::vector<double> levels;  ///< extremes they stand at, the high one first
};

/// All samples at an extreme that one run of them makes a clipped one (is_clipped), and those that
/// reach 0.999 of the nominal range (0: not known).
[[nodiscard]] ClippedSamples clipped_samples(const Eigen::Ref<const Eigen::VectorXd>& channel,
                                             double nominal_range);

}  // namespace rigfit::signal
