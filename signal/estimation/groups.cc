#include "signal/estimation/groups.h"

#include <gsl/gsl_cdf.h>

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

GroupMean mean_over_groups(std::span<const double> values, std::span<const double> variances) {
  const Map<const ArrayXd> x(values.data(), std::ssize(values)),
      v(variances.data(), std::ssize(variances));
  const double expected = static_cast<double>(x.size()) - 1;
  GroupMean p;
  ArrayXd w;
  const auto weighted_squares = [&] {
    w = (v + p.between_variance).inverse();
    p.mean = (w * x).sum() / w.sum();
    return (w * (x - p.mean).square()).sum();
  };
  p.cochran_Q = weighted_squares();
  if (x.size() > 1) p.chance = gsl_cdf_chisq_Q(p.cochran_Q, expected);
  if (x.size() > 1 && p.cochran_Q > expected) {
    // Q(tau^2) falls and is convex: Newton's steps from 0 rise to the root.
    for (int k = 0; k < 200; ++k) {
      const double excess = weighted_squares() - expected;
      const double step = excess / (w * (x - p.mean)).square().sum();
      p.between_variance += step;
      if (!(step > 1e-13 * p.between_variance)) break;
    }
    weighted_squares();
  }
  p.variance = 1 / w.sum();
  w *= p.variance;
  p.weights.assign(w.begin(), w.end());
  const double between = p.between_variance * w.square().sum();
  if (between > 0) p.degrees = expected * std::sqrt(p.variance / between);
  return p;
}

double jackknife_variance(std::span<const double> without) {
  const Map<const ArrayXd> x(without.data(), std::ssize(without));
  return (1 - 1 / static_cast<double>(x.size())) * (x - x.mean()).square().sum();
}

double GroupMean::std_95() const { return widening_95(degrees) * std::sqrt(variance); }

double widening_95(double degrees_of_freedom) {
  return coverage_factor(0.95, degrees_of_freedom) / coverage_factor(0.95, 0);
}

double coverage_factor(double coverage, double degrees_of_freedom) {
  const double p = 0.5 + 0.5 * coverage;
  return degrees_of_freedom > 0 ? gsl_cdf_tdist_Pinv(p, degrees_of_freedom)
                                : gsl_cdf_ugaussian_Pinv(p);
}

}  // namespace rigfit::signal
