#include "signal/detected_interval.h"

#include <algorithm>
#include <cmath>

namespace rigfit::signal {
namespace {

/// P(chi'^2 > T) with four and with six degrees of freedom and non-centrality mu^2: Poisson
/// mixtures of the central ones, which for even degrees are Poisson sums themselves.
struct Passing {
  double four = 0, six = 0;
};

Passing passing(double mu, double threshold) {
  const double mean = 0.5 * mu * mu, half = 0.5 * threshold;
  // log-weights would be needed beyond; `factor_of_detected` asks for less.
  double weight = std::exp(-mean), term = std::exp(-half);
  double central = term + term * half;  // four degrees
  term *= half;
  Passing out;
  // The weights are spent eight of their standard deviations past their mean.
  const int last = static_cast<int>(mean + 8 * std::sqrt(mean) + 20);
  for (int j = 0; j <= last; ++j) {
    term *= half / (j + 2);
    out.four += weight * central;
    central += term;  // two degrees more
    out.six += weight * central;
    weight *= mean / (j + 1);
  }
  return out;
}

}  // namespace

double factor_of_detected(double energy, double threshold, double factor) {
  const double r = std::sqrt(energy), t = std::sqrt(threshold);
  // Everything within the interval passes with a chance of 1 - 1e-6 and more.
  if (r > t + factor + 5) return factor;
  const auto observed = [&](double mu) {
    const Passing p = passing(mu, threshold);
    return mu * p.six / p.four;
  };
  const auto likelihood = [&](double mu) {
    const Passing p = passing(mu, threshold);
    return mu * mu * (p.six / p.four - 0.5) - std::log(p.four);
  };
  // Both rise with mu.
  const auto root = [](double low, double high, const auto& function, double wanted) {
    for (int k = 0; k < 50; ++k) {
      const double middle = 0.5 * (low + high);
      (function(middle) < wanted ? low : high) = middle;
    }
    return 0.5 * (low + high);
  };
  const double best = root(0, r, observed, r);
  const double wanted = likelihood(best) - 0.5 * factor * factor;
  if (wanted <= likelihood(0)) return std::max(factor, r);
  const double least = observed(root(0, best, likelihood, wanted));
  return std::max(factor, std::sqrt(std::max(0.0, energy - least * least)));
}

}  // namespace rigfit::signal
