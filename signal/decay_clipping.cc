#include "signal/decay_clipping.h"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace rigfit::signal {

using Eigen::Index;

Index clipped_by_fit(const DecaySamples& samples, const DecayBand& band,
                     const DecayModesOptions& options) {
  const Index n = samples.values.size();
  std::vector<bool> gap(static_cast<std::size_t>(n));
  for (const Index j : samples.missing) gap[static_cast<std::size_t>(j)] = true;
  double high = -std::numeric_limits<double>::infinity(), low = -high;
  for (Index j = 0; j < n; ++j) {
    if (gap[static_cast<std::size_t>(j)]) continue;
    high = std::max(high, samples.values(j)), low = std::min(low, samples.values(j));
  }
  const double rounding = 1e-12 * (high - low);
  std::vector<Index> at_high, at_low;
  for (Index j = 0; j < n; ++j) {
    if (gap[static_cast<std::size_t>(j)]) continue;
    if (samples.values(j) >= high - rounding) at_high.push_back(j);
    if (samples.values(j) <= low + rounding) at_low.push_back(j);
  }
  // One extreme is no rail; a fifth of the samples may be missing.
  if (at_high.size() < 2) at_high.clear();
  if (at_low.size() < 2) at_low.clear();
  if (at_high.empty() && at_low.empty()) return 0;
  DecaySamples others = samples;
  for (const auto* rail : {&at_high, &at_low}) {
    for (const Index j : *rail) others.missing.push_back(j), others.values(j) = 0;
  }
  if (5 * static_cast<Index>(others.missing.size()) > n) return 0;
  std::sort(others.missing.begin(), others.missing.end());
  const auto fit = find_decay_modes(others, band, options);
  if (!fit || fit->degrees < 1) return 0;
  const double variance = fit->residual_sum_squares / static_cast<double>(fit->degrees);
  Eigen::VectorXd says(n);
  for (Index j = 0; j < n; ++j) {
    says(j) = fit->offset + fit->drift * static_cast<double>(j) / static_cast<double>(n);
  }
  for (std::size_t m = 0; m < fit->poles.size(); ++m) says += fit->mode_signal(m);
  Index last = 0;
  const auto judge = [&](const std::vector<Index>& rail, double level, double sign) {
    double sum = 0;
    for (const Index j : rail) {
      const double beyond = std::max(0.0, sign * (says(j) - level));
      sum += beyond * beyond;
    }
    if (rail.empty() ||
        !(sum > variance * gsl_cdf_chisq_Qinv(1e-4, static_cast<double>(rail.size())))) {
      return;
    }
    last = std::max(last, rail.back() + 1);
  };
  judge(at_high, high, 1);
  judge(at_low, low, -1);
  return last;
}

}  // namespace rigfit::signal
