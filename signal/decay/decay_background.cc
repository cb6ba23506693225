#include "signal/decay/decay_steps.h"

#include <gsl/gsl_cdf.h>

#include <Eigen/LU>

#include "signal/sinusoids/residual_noise.h"

namespace rigfit::signal {
namespace {

constexpr std::size_t kMostSteadyTones = 3;
// The slowest mode has fallen by e^-7, to a thousandth.
constexpr double kDeadTimeConstants = 7;
// Slower than this over the window, an offset is a drift, which the fit has.
constexpr double kLeastFall = 1;

/// Steady lines of samples [from, to), amplitudes those at the first.
std::vector<KnownTone> steady_lines(const Ref<const VectorXd>& y, Index from, Index to) {
  if (to <= from) return {};
  VectorXd left = y.segment(from, to - from);
  const auto n = static_cast<double>(to - from);
  DecaySearchOptions search;
  search.candidates = 1, search.lowest = 4 / n;
  search.energy_over_noise = detection_threshold(to - from);
  std::vector<KnownTone> found;
  // One at a time: beside a strong one stand the side lobes of its line.
  for (std::size_t k = 0; k < kMostSteadyTones; ++k) {
    const DecaySamples samples = decay_samples(left, 0, to - from);
    const auto lines = search_decays(without_trend(left), search);
    if (lines.empty()) break;
    const auto free = fit_poles(samples, {lines.front().pole});
    if (!free) break;
    left -= free->mode_signal(0);
    // A tone neither falls nor grows by more than its uncertainty, or by hardly anything.
    const double std = std::sqrt(free->residual_sum_squares / static_cast<double>(free->degrees) *
                                 free->unit_covariance(2, 2));
    const double fall = std::abs(free->poles[0].real()) * n;
    if (fall > std::max(3 * std * n, 0.02) || 2 * std * n > 1) continue;
    const auto steady = fit_poles(samples, {Complex(0, lines.front().pole.imag())});
    if (!steady) continue;
    const std::vector<Index> own{0, 1, 3};  // Re C, Im C, Im p
    const Complex c = steady->amplitudes[0];
    found.push_back({{c.real(), c.imag(), steady->poles[0].imag()},
                     steady->unit_covariance(own, own).inverse()});
  }
  return found;
}

}  // namespace

std::vector<KnownTone> steady_tones(const Ref<const VectorXd>& y, Index quiet, Index start,
                                    Index end, const DampedSinusoidsFit& fit) {
  double slowest = std::numeric_limits<double>::infinity();
  for (const Complex p : fit.poles) {
    if (-p.real() * static_cast<double>(fit.samples) > 1) slowest = std::min(slowest, -p.real());
  }
  const auto dead =
      std::isfinite(slowest) ? start + static_cast<Index>(kDeadTimeConstants / slowest) : end;
  const bool before = quiet >= end - dead;
  auto tones = before ? steady_lines(y, 0, quiet) : steady_lines(y, dead, end);
  for (KnownTone& tone : tones) {
    tone = tone.at(before ? start : start - dead);
    if (!before) tone.information.setZero();
  }
  return tones;
}

std::optional<DampedSinusoidsFit> with_offset(const DecaySamples& samples,
                                              const DampedSinusoidsFit& fit) {
  double slowest_mode = std::numeric_limits<double>::infinity();
  for (const Complex pole : fit.poles) slowest_mode = std::min(slowest_mode, std::abs(pole));
  // What falls within half a cycle is the impact, or a mode; what hardly falls is a drift.
  const double fastest = 2 * slowest_mode / kTwoPi;
  const double slowest = kLeastFall / static_cast<double>(fit.samples);
  if (!(fastest > 2 * slowest)) return {};
  std::vector<Complex> poles = fit.poles;
  poles.emplace_back(-2 * slowest);
  auto joint = fit_poles(samples, poles);
  if (!joint) return {};
  const double rate = -joint->poles.back().real();
  const double explained = fit.residual_sum_squares - joint->residual_sum_squares;
  const double noise =
      residual_noise(joint->residual, joint->degrees).white_equivalent(rate / kTwoPi);
  if (!(rate > slowest && rate < fastest && explained > detection_threshold(fit.samples) * noise)) {
    return {};
  }
  return joint;
}

std::vector<Index> clipped_by_fit(const DecaySamples& samples, const DecayBand& band) {
  VectorXd y = samples.values;
  for (const Index j : samples.missing) y(j) = kNaN;
  VectorXd left = y;
  for (const double rail :
       {y.maxCoeff<Eigen::PropagateNumbers>(), y.minCoeff<Eigen::PropagateNumbers>()}) {
    if ((y.array() == rail).count() > 1) left = (y.array() == rail).select(kNaN, left);
  }
  DecaySamples others = decay_samples(left, 0, y.size());
  if (others.missing.size() == samples.missing.size()) return {};
  others.known = samples.known;
  const auto fit = find_decay_modes(others, band);
  if (!fit || fit->degrees < 1) return {};
  const double variance = fit->residual_sum_squares / static_cast<double>(fit->degrees);
  const VectorXd says = fit->signal();
  std::vector<Index> clipped;
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
