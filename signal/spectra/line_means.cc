#include "signal/spectra/line_means.h"

#include <algorithm>

namespace rigfit::signal {

Eigen::ArrayXd mean_over_lines(const Eigen::Ref<const Eigen::ArrayXd>& powers, Eigen::Index half) {
  using Eigen::Index;
  Eigen::ArrayXd sums(powers.size() + 1), result(powers.size());
  sums[0] = 0;
  for (Index k = 0; k < powers.size(); ++k) sums[k + 1] = sums[k] + powers[k];
  for (Index k = 0; k < powers.size(); ++k) {
    const Index first = std::max<Index>(0, k - half), last = std::min(powers.size(), k + half + 1);
    result[k] = std::max(0.0, sums[last] - sums[first]) / static_cast<double>(last - first);
  }
  return result;
}

}  // namespace rigfit::signal
