#include "signal/sinusoids/detected_strength.h"

#include <gsl/gsl_sf_bessel.h>

#include <cmath>

namespace rigfit::signal {
namespace {

/// P_6(mu) / P_4(mu). With even degrees the central distributions are sums of Poisson weights, the
/// non-central ones their Poisson mixtures.
double passing_ratio(double mu, double threshold) {
  // All but 1e-9 pass: both are 1 (and the weights below would underflow from mu = 38 on).
  if (mu > std::sqrt(threshold) + 6) return 1;
  const double mean = 0.5 * mu * mu, half = 0.5 * threshold;
  double weight = std::exp(-mean), term = std::exp(-half);
  double central = term + term * half;  // four degrees
  term *= half;
  double four = 0, six = 0;
  // The weights are spent eight of their standard deviations past their mean.
  const int last = static_cast<int>(mean + 8 * std::sqrt(mean) + 20);
  for (int j = 0; j <= last; ++j) {
    term *= half / (j + 2);
    four += weight * central;
    central += term;  // two degrees more
    six += weight * central;
    weight *= mean / (j + 1);
  }
  return six / four;
}

/// I_2(x) / I_1(x), by the recurrence but where it cancels.
double bessel_ratio(double x) {
  if (x < 1e-3) return 0.25 * x;
  return gsl_sf_bessel_I0_scaled(x) / gsl_sf_bessel_I1_scaled(x) - 2 / x;
}

}  // namespace

double detected_strength(double energy, double threshold) {
  const double r = std::sqrt(energy);
  if (energy <= 4 * passing_ratio(0, threshold)) return 0;
  const auto slope = [&](double mu) {
    return r * bessel_ratio(r * mu) - mu * passing_ratio(mu, threshold);
  };
  double low = 0, high = r;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (slope(middle) > 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace rigfit::signal
