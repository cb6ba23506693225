#include "signal/estimation/groups.h"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace rigfit::signal {
namespace {

double weighted_squares(std::span<const double> x, std::span<const double> v, double tau2,
                        double& mean) {
  double sw = 0, swx = 0, squares = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sw += 1 / (v[i] + tau2), swx += x[i] / (v[i] + tau2);
  mean = swx / sw;
  for (std::size_t i = 0; i < x.size(); ++i) {
    squares += (x[i] - mean) * (x[i] - mean) / (v[i] + tau2);
  }
  return squares;
}

}  // namespace

GroupMean mean_over_groups(std::span<const double> x, std::span<const double> v) {
  GroupMean p;
  const double expected = static_cast<double>(x.size()) - 1;
  p.cochran_Q = weighted_squares(x, v, 0, p.mean);
  if (x.size() > 1) p.chance = gsl_cdf_chisq_Q(p.cochran_Q, expected);
  if (x.size() > 1 && p.cochran_Q > expected) {
    // Q(tau^2) falls and is convex: Newton's steps from 0 rise to the root.
    for (int k = 0; k < 200; ++k) {
      const double Q = weighted_squares(x, v, p.between_variance, p.mean);
      double slope = 0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double d = (x[i] - p.mean) / (v[i] + p.between_variance);
        slope += d * d;
      }
      const double step = (Q - expected) / slope;
      p.between_variance += step;
      if (!(step > 1e-13 * p.between_variance)) break;
    }
    weighted_squares(x, v, p.between_variance, p.mean);
  }
  double sw = 0, between = 0;
  for (double a : v) sw += 1 / (a + p.between_variance);
  for (double a : v) {
    p.weights.push_back(1 / (a + p.between_variance) / sw);
    between += p.between_variance * p.weights.back() * p.weights.back();
  }
  p.variance = 1 / sw;
  if (between > 0) p.degrees = expected * std::sqrt(p.variance / between);
  return p;
}

double jackknife_variance(std::span<const double> without) {
  const auto G = static_cast<double>(without.size());
  const double mean = std::accumulate(without.begin(), without.end(), 0.0) / G;
  double squares = 0;
  for (const double x : without) squares += (x - mean) * (x - mean);
  return (G - 1) / G * squares;
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
