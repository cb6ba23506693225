#include "signal/decay/decay_clipping.h"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

using Eigen::Index;

namespace {

// What lies beyond a rail is this many times as large, squared, as the fit errs near by.
constexpr double kOverLocal = 6;

/// Mean square of the residual within a cycle of sample j: of a fit that is not right there, more
/// than noise. Samples left out have none.
double level_near(const DampedSinusoidsFit& fit, Index j, Index cycle) {
  const Index from = std::max<Index>(0, j - cycle), to = std::min(fit.samples, j + cycle + 1);
  double sum = 0;
  Index count = 0;
  for (Index k = from; k < to; ++k) {
    if (k != j && fit.residual(k) != 0) sum += fit.residual(k) * fit.residual(k), ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

/// Whether the fit to the others goes beyond sample j, an extreme on the side of `sign`: left out
/// it is missed by residual / (1 - leverage).
bool cut_off(const DampedSinusoidsFit& fit, Index j, double sign, Index cycle) {
  const Index parameters = fit.unit_covariance.rows();
  if (parameters == 0 || fit.degrees < 2) return false;
  const Eigen::VectorXd row = fit.jacobian_rows(j, 1).transpose();
  const double rest = 1 - row.dot(fit.unit_covariance * row);
  const double r = fit.residual(j);
  if (!(rest > 1e-6) || sign * r >= 0) return false;
  const double others =
      (fit.residual_sum_squares - r * r / rest) / static_cast<double>(fit.degrees - 1);
  const double missed = r * r / rest;
  return missed > others * gsl_cdf_chisq_Qinv(1e-4, 1) &&
         missed > kOverLocal * level_near(fit, j, cycle);
}

}  // namespace

Index clipped_by_fit(const DecaySamples& samples, const DampedSinusoidsFit& whole,
                     const DecayBand& band, const DecayModesOptions& options) {
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
  const double w = whole.poles[strongest_mode(whole, band)].imag();
  const auto cycle = std::max<Index>(4, static_cast<Index>(std::ceil(kTwoPi / w)));
  Index last = 0;
  if (at_high.size() == 1) {
    if (cut_off(whole, at_high[0], 1, cycle)) last = at_high[0] + 1;
    at_high.clear();
  }
  if (at_low.size() == 1) {
    if (cut_off(whole, at_low[0], -1, cycle)) last = std::max(last, at_low[0] + 1);
    at_low.clear();
  }
  if (at_high.empty() && at_low.empty()) return last;
  DecaySamples others = samples;
  for (const auto* rail : {&at_high, &at_low}) {
    for (const Index j : *rail) others.missing.push_back(j), others.values(j) = 0;
  }
  // A fifth of the samples may be missing.
  if (5 * static_cast<Index>(others.missing.size()) > n) return last;
  std::sort(others.missing.begin(), others.missing.end());
  const auto fit = find_decay_modes(others, band, options);
  if (!fit || fit->degrees < 1) return last;
  const double variance = fit->residual_sum_squares / static_cast<double>(fit->degrees);
  Eigen::VectorXd says(n);
  for (Index j = 0; j < n; ++j) {
    says(j) = fit->offset + fit->drift * static_cast<double>(j) / static_cast<double>(n);
  }
  for (std::size_t m = 0; m < fit->poles.size(); ++m) says += fit->mode_signal(m);
  const auto judge = [&](const std::vector<Index>& rail, double level, double sign) {
    double sum = 0, near = 0;
    for (const Index j : rail) {
      const double beyond = std::max(0.0, sign * (says(j) - level));
      sum += beyond * beyond;
      near = std::max(near, level_near(*fit, j, cycle));
    }
    const auto count = static_cast<double>(rail.size());
    if (rail.empty() || !(sum > variance * gsl_cdf_chisq_Qinv(1e-4, count)) ||
        !(sum > kOverLocal * near * count)) {
      return;
    }
    last = std::max(last, rail.back() + 1);
  };
  judge(at_high, high, 1);
  judge(at_low, low, -1);
  return last;
}

}  // namespace rigfit::signal
