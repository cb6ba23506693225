#include "signal/decay/decay_clipping.h"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

using Eigen::Index;

std::vector<Index> clipped_by_fit(const DecaySamples& samples, const DecayBand& band,
                                  const DecayModesOptions& options) {
  Eigen::VectorXd y = samples.values;
  for (const Index j : samples.missing) y(j) = kNaN;
  const double high = y.maxCoeff<Eigen::PropagateNumbers>();
  const double low = y.minCoeff<Eigen::PropagateNumbers>();
  struct Rail {
    double sign, level;
    std::vector<Index> at;
  };
  Rail rails[] = {{1, high, {}}, {-1, low, {}}};
  std::vector<Index> clipped;
  DecaySamples others = samples;
  for (auto& [sign, level, at] : rails) {
    for (Index j = 0; j < y.size(); ++j) {
      if (sign * (y(j) - level) >= -1e-12 * (high - low)) at.push_back(j);
    }
    if (at.size() == 1) at.clear();
    for (const Index j : at) others.missing.push_back(j), others.values(j) = 0;
  }
  if (others.missing.size() == samples.missing.size()) return clipped;
  std::sort(others.missing.begin(), others.missing.end());
  const auto fit = find_decay_modes(others, band, options);
  if (!fit || fit->degrees < 1) return clipped;
  const double variance = fit->residual_sum_squares / static_cast<double>(fit->degrees);
  Eigen::VectorXd says = Eigen::VectorXd::LinSpaced(
      y.size(), fit->offset,
      fit->offset + fit->drift * static_cast<double>(y.size() - 1) / static_cast<double>(y.size()));
  for (std::size_t m = 0; m < fit->poles.size(); ++m) says += fit->mode_signal(m);
  for (const auto& [sign, level, at] : rails) {
    double sum = 0;
    for (const Index j : at) sum += std::pow(std::max(0.0, sign * (says(j) - level)), 2);
    const auto count = static_cast<double>(at.size());
    if (!at.empty() && sum > variance * gsl_cdf_chisq_Qinv(1e-4, count)) {
      clipped.insert(clipped.end(), at.begin(), at.end());
    }
  }
  return clipped;
}

}  // namespace rigfit::signal
