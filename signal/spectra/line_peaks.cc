#include "signal/spectra/line_peaks.h"

#include <algorithm>
#include <cmath>

#include "signal/estimation/robust.h"

namespace rigfit::signal {

std::vector<LinePeak> line_peaks(const Eigen::Ref<const Eigen::VectorXd>& frequency_hz,
                                 const Eigen::Ref<const Eigen::VectorXd>& magnitude,
                                 std::size_t most) {
  using Eigen::Index;
  std::vector<LinePeak> peaks;
  const Index n = magnitude.size();
  if (n < 5 || frequency_hz.size() != n || !magnitude.allFinite()) return peaks;
  const double floor = 2 * median(std::vector<double>(magnitude.begin(), magnitude.end()));
  for (Index k = 1; k + 1 < n; ++k) {
    const double top = magnitude[k];
    if (!(top > magnitude[k - 1]) || !(top >= magnitude[k + 1]) || !(top > floor)) continue;
    double left = top, right = top;
    for (Index j = k; j-- > 0 && magnitude[j] <= top && left > 0.5 * top;) {
      left = std::min(left, magnitude[j]);
    }
    for (Index j = k + 1; j < n && magnitude[j] <= top && right > 0.5 * top; ++j) {
      right = std::min(right, magnitude[j]);
    }
    if (std::max(left, right) > 0.5 * top) continue;
    LinePeak peak{frequency_hz[k], top};
    if (magnitude[k - 1] > 0 && magnitude[k + 1] > 0) {
      const double a = std::log(magnitude[k - 1]), b = std::log(top),
                   c = std::log(magnitude[k + 1]);
      const double curvature = a - 2 * b + c;
      if (curvature < 0) {
        peak.frequency_hz +=
            0.5 * (a - c) / curvature * 0.5 * (frequency_hz[k + 1] - frequency_hz[k - 1]);
      }
    }
    peaks.push_back(peak);
  }
  std::sort(peaks.begin(), peaks.end(),
            [](const auto& a, const auto& b) { return a.value > b.value; });
  if (peaks.size() > most) peaks.resize(most);
  std::sort(peaks.begin(), peaks.end(),
            [](const auto& a, const auto& b) { return a.frequency_hz < b.frequency_hz; });
  return peaks;
}

}  // namespace rigfit::signal
