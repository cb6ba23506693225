#include "signal/decay/decay_clipping.h"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

using Eigen::Index;

std::vector<Index> clipped_by_fit(const DecaySamples& samples, const DecayBand& band) {
  Eigen::VectorXd y = samples.values;
  for (const Index j : samples.missing) y(j) = kNaN;
  std::vector<Index> clipped;
  Eigen::VectorXd left = y;
  for (const double rail :
       {y.maxCoeff<Eigen::PropagateNumbers>(), y.minCoeff<Eigen::PropagateNumbers>()}) {
    if ((y.array() == rail).count() > 1) left = (y.array() == rail).select(kNaN, left);
  }
  DecaySamples others = decay_samples(left, 0, y.size());
  if (others.missing.size() == samples.missing.size()) return clipped;
  others.known = samples.known;
  const auto fit = find_decay_modes(others, band);
  if (!fit || fit->degrees < 1) return clipped;
  const double variance = fit->residual_sum_squares / static_cast<double>(fit->degrees);
  Eigen::VectorXd says = Eigen::VectorXd::LinSpaced(
      y.size(), fit->offset,
      fit->offset + fit->drift * static_cast<double>(y.size() - 1) / static_cast<double>(y.size()));
  for (std::size_t m = 0; m < fit->poles.size(); ++m) says += fit->mode_signal(m);
  // The high rail, then the low one.
  for (const double sign : {1.0, -1.0}) {
    const double rail = sign * (sign * y).maxCoeff<Eigen::PropagateNumbers>();
    std::vector<Index> at;
    double sum = 0;
    for (Index j = 0; j < y.size(); ++j) {
      if (y(j) != rail) continue;
      at.push_back(j);
      sum += std::pow(std::max(0.0, sign * (says(j) - rail)), 2);
    }
    if (at.size() > 1 &&
        sum > variance * gsl_cdf_chisq_Qinv(1e-4, static_cast<double>(at.size()))) {
      clipped.insert(clipped.end(), at.begin(), at.end());
    }
  }
  return clipped;
}

}  // namespace rigfit::signal
