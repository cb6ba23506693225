#include "signal/decay/decay_clipping.h"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>

#include "signal/numerics/numbers.h"

namespace rigfit::signal {
namespace {

using Eigen::Index;

constexpr double kChance = 1e-4, kOverLocal = 6;

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

}  // namespace

DecaySamples without(const DecaySamples& samples, const std::vector<Index>& places) {
  DecaySamples left = samples;
  Index kept = 0;
  auto next = places.begin();
  for (Index j = 0; j < samples.t.size(); ++j) {
    if (next != places.end() && *next == j) {
      ++next;
      continue;
    }
    left.t(kept) = samples.t(j), left.y(kept++) = samples.y(j);
  }
  left.t.conservativeResize(kept), left.y.conservativeResize(kept);
  return left;
}

std::vector<Index> clipped_samples(const DecaySamples& samples, const DampedSinusoidsFit& whole,
                                   const DecayBand& band) {
  const double high = samples.y.maxCoeff(), low = samples.y.minCoeff();
  const double rounding = 1e-12 * (high - low);
  std::vector<Index> rails[2], both;
  const double levels[2] = {high, low};
  for (Index j = 0; j < samples.y.size(); ++j) {
    for (int side = 0; side < 2; ++side) {
      if (std::abs(samples.y(j) - levels[side]) <= rounding) rails[side].push_back(j);
    }
  }
  for (int side = 0; side < 2; ++side) {
    // One or two: noise makes an extreme lie beyond the fit, a rail makes it fall short.
    double missed = 0;
    for (const Index j : rails[side]) {
      const auto at = std::clamp<Index>(std::lround(samples.t(j)), 0, whole.samples - 1);
      missed += (side == 0 ? -1 : 1) * whole.residual(at) / static_cast<double>(rails[side].size());
    }
    if (rails[side].size() < 3 && !(missed > 3 * std::sqrt(whole.variance()))) rails[side].clear();
    both.insert(both.end(), rails[side].begin(), rails[side].end());
  }
  if (both.empty() || 2 * both.size() > static_cast<std::size_t>(samples.y.size())) return both;
  std::sort(both.begin(), both.end());
  const auto pole = whole.poles[strongest_mode(whole, band)];
  const auto found = find_decay_modes(without(samples, both), band, {}, pole);
  if (!found) return {};
  const DampedSinusoidsFit& fit = *found;
  const auto cycle = std::max<Index>(4, static_cast<Index>(std::ceil(kTwoPi / pole.imag())));
  const auto says = [&](double t) {
    double value = fit.offset + fit.drift * t / static_cast<double>(fit.samples);
    for (std::size_t m = 0; m < fit.poles.size(); ++m) {
      value += (fit.amplitudes[m] * std::exp(fit.poles[m] * t)).real();
    }
    return fit.relaxation ? value + fit.relaxation_amplitude * std::exp(-*fit.relaxation * t)
                          : value;
  };
  std::vector<Index> clipped;
  for (int side = 0; side < 2; ++side) {
    double sum = 0, near = 0;
    for (const Index j : rails[side]) {
      const double beyond = (side == 0 ? 1 : -1) * (says(samples.t(j)) - levels[side]);
      sum += std::pow(std::max(0.0, beyond), 2);
      near = std::max(near, level_near(fit, std::lround(samples.t(j)), cycle));
    }
    const auto count = static_cast<double>(rails[side].size());
    if (count > 0 && sum > fit.variance() * gsl_cdf_chisq_Qinv(kChance, count) &&
        sum > kOverLocal * near * count) {
      clipped.insert(clipped.end(), rails[side].begin(), rails[side].end());
    }
  }
  std::sort(clipped.begin(), clipped.end());
  return clipped;
}

}  // namespace rigfit::signal
