#include "ident/axial/axial_average.h"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>

#include "ident/axial/axial_result.h"
#include "ident/statistics/uncertainty.h"

namespace rigfit::ident {
namespace {

double variance_of(const AxialFit& fit, std::string_view source) {
  double sum = 0;
  for (const auto& c : fit.contributions) sum += c.source == source ? c.variance : 0;
  return sum;
}

// Expanded uncertainties of what is known from scatter and of the rest are added in squares: one
// factor by Welch and Satterthwaite falls short when a part known to two degrees of freedom comes
// out small by chance (R. Willink, Metrologia 44 (2007) 340).
void distribution(AxialCandidate& candidate, double repeat_degrees, double coverage) {
  const auto& fit = candidate.fit;
  const double total = fit.EA_relative_std * fit.EA_relative_std;
  double scattering = variance_of(fit, "frequency"), degrees = repeat_degrees;
  if (fit.between_variance > 0) {
    scattering += variance_of(fit, "length") + fit.between_variance;
    degrees = candidate.scatter_degrees =
        fit.degrees * std::sqrt(scattering / fit.between_variance);
  }
  candidate.scale = fit.EA_relative_std;
  if (!(degrees > 0) || !(scattering > 1e-9 * total)) return;
  candidate.degrees = degrees * std::pow(total / scattering, 2);
  const double of_scatter = coverage_factor(coverage, degrees);
  const double of_rest = coverage_factor(coverage, 0);
  candidate.scale =
      std::sqrt(of_scatter * of_scatter * scattering + of_rest * of_rest * (total - scattering)) /
      coverage_factor(coverage, candidate.degrees);
}

double penalty(const AxialFit& fit) {
  if (!(fit.between_variance > 0)) return 0;
  const double share =
      fit.between_variance /
      (fit.between_variance + variance_of(fit, "frequency") + variance_of(fit, "length"));
  return share * (1 + (fit.series ? 3.0 / fit.degrees : 0));
}

}  // namespace

std::vector<AxialCandidate> axial_candidates(std::span<const AxialLengthData> lengths,
                                             const AxialSetup& setup, double repeat_degrees,
                                             double coverage, bool& slope_left_out) {
  std::vector<AxialCandidate> all;
  slope_left_out = false;
  const auto& known = setup.series_compliance_std_m_N;
  double start = std::exp(lengths.front().log_omega_squared) * setup.mass_kg.value;
  for (const double told : {setup.adapter_stiffness_N_m.value, setup.frame_stiffness_N_m.value}) {
    if (told > start) start = 1 / (1 / start - 1 / told);
  }
  start *= lengths.front().length_m;
  const auto add = [&](bool series) {
    const AxialFit plain = fit_axial(lengths, setup, series, 0, start);
    if (!plain.converged) return;
    if (series && !known && !(plain.EA_relative_std < 0.25)) {
      slope_left_out = true;
      return;
    }
    all.push_back({plain});
    const AxialFit scattering = fit_axial_with_scatter(lengths, setup, plain);
    if (scattering.converged && scattering.between_std > 0) all.push_back({scattering});
  };
  if (!known || *known == 0) add(false);
  if (known ? *known > 0 : lengths.size() > 1) add(true);
  double best = -INFINITY, sum = 0;
  for (auto& c : all) {
    distribution(c, repeat_degrees, coverage);
    c.weight = c.fit.log_likelihood - penalty(c.fit);
    best = std::max(best, c.weight);
  }
  for (auto& c : all) sum += c.weight = std::exp(c.weight - best);
  for (auto& c : all) c.weight /= sum;
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.weight > b.weight; });
  return all;
}

double axial_quantile(std::span<const AxialCandidate> candidates, double p) {
  // In b = 1 / EA, where P(EA < x) = P(b > 1 / x).
  const auto above = [&](double b) {
    double sum = 0;
    for (const auto& c : candidates) {
      const double centre = 1 / c.fit.EA_N;
      if (!(c.scale > 0)) {
        sum += c.weight * (b < centre ? 1 : b > centre ? 0 : 0.5);
        continue;
      }
      const double z = (b - centre) / (centre * c.scale);
      sum += c.weight * (c.degrees > 0 ? gsl_cdf_tdist_Q(z, c.degrees) : gsl_cdf_ugaussian_Q(z));
    }
    return sum;
  };
  double low = INFINITY, high = 0;
  for (const auto& c : candidates) {
    low = std::min(low, 1 / c.fit.EA_N), high = std::max(high, 1 / c.fit.EA_N);
  }
  // No stiffness is infinite and none zero: the search ends a thousandfold away.
  const double least = 1e-3 * low, most = 1e3 * high;
  low = least, high = most;
  for (int k = 0; k < 200 && high - low > 1e-15 * high; ++k) {
    const double middle = 0.5 * (low + high);
    (above(middle) > p ? low : high) = middle;
  }
  return 2 / (low + high);
}

}  // namespace rigfit::ident
