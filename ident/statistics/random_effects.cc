#include "ident/statistics/random_effects.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace rigfit::ident {
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

RandomEffects pool_groups(std::span<const double> x, std::span<const double> v) {
  RandomEffects p;
  const double expected = static_cast<double>(x.size()) - 1;
  p.cochran_Q = weighted_squares(x, v, 0, p.mean);
  if (x.size() > 1 && p.cochran_Q > expected) {
    // tau^2 such that the weighted sum of squares equals its expectation.
    double low = 0, high = 0;
    for (double a : x) high = std::max(high, (a - p.mean) * (a - p.mean));
    high *= 4 * static_cast<double>(x.size());
    for (int k = 0; k < 200 && high - low > 1e-14 * high; ++k) {
      const double middle = 0.5 * (low + high);
      (weighted_squares(x, v, middle, p.mean) > expected ? low : high) = middle;
    }
    p.between_variance = 0.5 * (low + high);
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

}  // namespace rigfit::ident
