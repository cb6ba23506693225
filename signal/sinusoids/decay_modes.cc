#include "signal/sinusoids/decay_modes.h"

#include <gsl/gsl_cdf.h>

#include "signal/numerics/factorisations.h"
#include "signal/numerics/power_sums.h"
#include "signal/sinusoids/residual_noise.h"

namespace rigfit::signal {
namespace {

constexpr Index kFewDegrees = 200;

// Radians up to which a record holds no more numbers, 2 a cycle, than so many modes and a line.
double few_cycles(std::size_t modes) { return kTwoPi * (2 * static_cast<double>(modes) + 1); }

bool is_damped(Complex pole) { return !is_tone(pole) && !is_offset(pole); }

std::size_t modes_of(const DampedSinusoidsFit& fit) {
  return static_cast<std::size_t>(std::ranges::count_if(fit.poles, is_damped));
}

// An arc is no oscillation: a polynomial with as many coefficients as the modes up to a frequency
// must leave twice what they do, or half of what they explain, or, where there is one, so much more
// that noise would not show it.
bool oscillate(const DecaySamples& samples, const DampedSinusoidsFit& fit, double up_to) {
  const Index n = fit.samples;
  Index count = 2;
  VectorXd values = fit.residual;
  for (std::size_t m = 0; m < fit.poles.size(); ++m) {
    if (!is_damped(fit.poles[m]) || fit.poles[m].imag() > up_to) continue;
    values += fit.mode_signal(m), count += 4;
  }
  MatrixXd polynomials = MatrixXd::Ones(n, count);
  const VectorXd t = polynomials.col(1) = VectorXd::LinSpaced(n, -1, 1);
  for (Index k = 2; k < count; ++k) {  // Chebyshev's
    polynomials.col(k) = 2 * t.cwiseProduct(polynomials.col(k - 1)) - polynomials.col(k - 2);
  }
  for (const Index j : samples.missing) polynomials.row(j).setZero(), values(j) = 0;
  const double left = fit.residual_sum_squares;
  const double more = least_sum_squares(polynomials, values) - left;
  const double explained = least_sum_squares(polynomials.leftCols(2), values) - left;
  const double noise = detection_threshold(n) * left / static_cast<double>(fit.degrees);
  return more > left || more > 0.5 * explained || (count == 6 && more > noise);
}

std::size_t nearest(const DampedSinusoidsFit& fit, Complex pole) {
  const auto apart = [pole](Complex p) { return std::abs(p - pole); };
  return static_cast<std::size_t>(std::ranges::min_element(fit.poles, {}, apart) -
                                  fit.poles.begin());
}

// Whether noise of the residual's variance would take out so much with one mode more, in the best
// among all cells of the bank, with probability kFalseAlarm at most.
bool passes_fisher(double gain, const DampedSinusoidsFit& fit) {
  const double degrees = static_cast<double>(fit.degrees);
  const double ratio = gain / 4 / std::max(fit.residual_sum_squares / degrees, 1e-300);
  const double cells = std::exp(0.5 * detection_threshold(fit.samples)) * kFalseAlarm;
  return gsl_cdf_fdist_Q(ratio, 4, degrees) * cells < kFalseAlarm;
}

// Modes that beat for less than 0.4 beats while both last are not told apart; under one and a
// half, one mode whose amplitude and phase depart from an exponential (t^2 and t^3: as many
// parameters) must explain less than two do: half as much where the two leave something too, or
// not more where they leave nothing but noise.
bool told_apart(const DampedSinusoidsFit& fit, const DampedSinusoidsFit& more,
                double noise_variance) {
  const auto n = static_cast<double>(fit.samples);
  for (std::size_t i = 0; i < more.poles.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const double a = std::max(-more.poles[i].real(), -more.poles[k].real());
      const double both = a > 0 ? std::min(n, 3 / a) : n;
      const double beats = std::abs(more.poles[i].imag() - more.poles[k].imag()) / kTwoPi * both;
      if (beats < 0.4) return false;
      if (beats >= 1.5) continue;
      const std::size_t near = nearest(fit, more.poles[i]);
      const double departing = departing_residual(fit, std::span(&near, 1));
      if (beats >= 0.5 && more.residual_sum_squares < 0.5 * departing) continue;
      if (more.residual_sum_squares > departing + 4 * noise_variance) return false;
      const std::size_t pair[] = {i, k};
      const double left = departing_residual(more, pair);
      const double structure = (more.residual_sum_squares - left) / noise_variance;
      if (structure > gsl_cdf_chisq_Qinv(1e-3, 8)) return false;
    }
  }
  return true;
}

bool worthwhile(const DecaySamples& samples, const DampedSinusoidsFit& fit,
                const DampedSinusoidsFit& more, double noise_variance) {
  const bool first = modes_of(fit) == 0;
  const double gain = fit.residual_sum_squares - more.residual_sum_squares;
  if (!first && !(gain > detection_threshold(fit.samples) * noise_variance)) return false;
  // Few samples know little of the noise: Fisher's test as well.
  if ((first || more.degrees < kFewDegrees) && !passes_fisher(gain, more)) return false;
  const double white = more.residual_sum_squares / static_cast<double>(more.degrees);
  const auto n = static_cast<double>(fit.samples);
  // Under a third of a cycle, or growing by e^2.9, at the bounds of the fit.
  if (!std::ranges::all_of(more.poles, [n](Complex p) {
        return is_offset(p) || (p.imag() * n >= 0.3 * kTwoPi && p.real() * n <= 2.9);
      })) {
    return false;
  }
  const Complex p = more.poles.back();
  if (first) {
    const double lasts = std::min(n, 3 / std::max(-p.real(), 1e-300));
    return p.imag() * lasts > few_cycles(1) || oscillate(samples, more, p.imag());
  }
  const auto of_new = static_cast<Index>(4 * (more.poles.size() - 1));
  const ArrayXd stds = (white * more.unit_covariance.diagonal().segment<4>(of_new)).cwiseSqrt();
  if (stds(3) > 0.05 * p.imag()) return false;
  // Strongly damped ones explain transients as readily as modes: they must be well determined.
  if (damping_ratio_of(p) > 0.15 && stds(2) > 0.2 * std::abs(p.real())) return false;
  return told_apart(fit, more, noise_variance);
}

// One mode more, or nothing when none is worth it; the first from several starts.
std::optional<DampedSinusoidsFit> one_more(const DecaySamples& samples,
                                           const DampedSinusoidsFit& fit, double lowest,
                                           double highest) {
  const bool first = modes_of(fit) == 0;
  DecaySearchOptions search;
  search.lowest = lowest, search.highest = highest, search.candidates = 3;
  // Half of what noise may show: Fisher's test of the fit decides.
  search.energy_over_noise = (first ? 0.5 : 1) * detection_threshold(fit.samples);
  const auto found = search_decays(fit.residual, search);
  std::optional<DampedSinusoidsFit> best;
  for (const auto& candidate : found) {
    if (first && candidate.energy < 0.3 * found.front().energy) break;
    auto poles = fit.poles;
    poles.push_back(candidate.pole);
    auto more = fit_poles(samples, poles);
    if (!more || !worthwhile(samples, fit, *more, candidate.noise_variance)) continue;
    if (!best || more->residual_sum_squares < best->residual_sum_squares) best = std::move(more);
    if (!first) break;
  }
  return best;
}

/// The mode that noise passes for most readily, of the residual's colour and as large as it is
/// while the mode lasts; nothing when all stand out.
std::optional<std::size_t> passing_for_noise(const DampedSinusoidsFit& fit) {
  const ResidualNoise noise = residual_noise(fit.residual, fit.degrees);
  const FitUncertainty uneven = fit_uncertainty(fit, noise);
  // Four unknowns, over all cells of the search.
  const double needed = gsl_cdf_chisq_Qinv(std::exp(-0.5 * detection_threshold(fit.samples)), 4);
  std::optional<std::size_t> weakest;
  double least = 1;
  for (std::size_t m = 0; m < fit.poles.size(); ++m) {
    if (!is_damped(fit.poles[m])) continue;
    const double widening = uneven.widening_of_mode(m);
    const double variance = widening * noise.white_equivalent(fit.poles[m].imag() / kTwoPi);
    const double evidence = mode_energy(fit, m) / std::max(needed * variance, 1e-300);
    if (evidence < least) least = evidence, weakest = m;
  }
  return weakest;
}

}  // namespace

std::optional<DampedSinusoidsFit> fit_poles(const DecaySamples& samples,
                                            const std::vector<Complex>& poles) {
  const auto present = samples.values.size() - static_cast<Index>(samples.missing.size());
  if (present <= 4 * static_cast<Index>(poles.size()) + 2) return {};
  DampedSinusoidsOptions options;
  options.known = samples.known;
  auto fit = fit_damped_sinusoids(samples.values, poles, options, samples.missing);
  if (fit.unit_covariance.size() == 0) return {};
  return fit;
}

DecaySamples decay_samples(const Ref<const VectorXd>& y, Index start, Index end) {
  DecaySamples s;
  s.values = y.segment(start, end - start);
  for (Index j = 0; j < s.values.size(); ++j) {
    if (!std::isfinite(s.values(j))) s.values(j) = 0, s.missing.push_back(j);
  }
  return s;
}

bool DecayBand::contains(Complex pole) const {
  const double f = std::abs(pole) / kTwoPi;
  return is_damped(pole) && (all || (f >= low && f <= high));
}

double damping_ratio_of(Complex pole) { return -pole.real() / std::abs(pole); }

double mode_energy(const DampedSinusoidsFit& fit, std::size_t m) {
  return fit.mode_signal(m).squaredNorm();
}

std::optional<DampedSinusoidsFit> find_decay_modes(const DecaySamples& samples,
                                                   const DecayBand& band,
                                                   const std::vector<Complex>& known,
                                                   int max_modes) {
  auto fit = fit_poles(samples, known);
  if (!fit) return fit;
  const auto limit = static_cast<std::size_t>(max_modes);
  while (fit->poles.size() < limit) {
    auto more = one_more(samples, *fit, 0, 0.5);
    if (!more) break;
    fit = std::move(more);
  }
  const auto in_band = [&] {
    return static_cast<std::size_t>(
        std::ranges::count_if(fit->poles, [&](Complex p) { return band.contains(p); }));
  };
  // A slow sway may be no oscillation, and larger than what is asked for.
  while (!band.all && in_band() < limit && fit->poles.size() < 2 * limit) {
    auto more = one_more(samples, *fit, band.low, band.high);
    if (!more) break;
    fit = std::move(more);
  }
  if (modes_of(*fit) == 0) return {};
  // Not before all modes are found: what is left of a mode looks like noise of its own envelope.
  while (modes_of(*fit) > 1) {
    const auto m = passing_for_noise(*fit);
    if (!m) break;
    auto poles = fit->poles;
    poles.erase(poles.begin() + static_cast<std::ptrdiff_t>(*m));
    auto fewer = fit_poles(samples, poles);
    if (!fewer) break;
    fewer->noise_like = std::move(fit->noise_like);
    fewer->noise_like.push_back(fit->poles[*m]);
    fit = std::move(fewer);
  }
  std::vector<double> w;
  for (const Complex p : fit->poles) {
    if (is_damped(p)) w.push_back(p.imag());
  }
  std::ranges::sort(w);
  const auto n = static_cast<double>(fit->samples);
  std::size_t slow = 0;
  while (slow < w.size() && w[slow] * n < few_cycles(slow + 1)) ++slow;
  if (slow > 0 && !oscillate(samples, *fit, w[slow - 1])) fit->drift_up_to = w[slow - 1];
  return fit;
}

double departing_residual(const DampedSinusoidsFit& fit, std::span<const std::size_t> modes) {
  const auto n = fit.samples;
  MatrixXd columns(n, 8 * static_cast<Index>(modes.size()));
  const ArrayXd t = ArrayXd::LinSpaced(n, 0, static_cast<double>(n - 1)) / static_cast<double>(n);
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const Complex pole = fit.poles[modes[m]];
    auto own = columns.middleCols<8>(8 * static_cast<Index>(m));
    ArrayXcd z = powers(pole, n);
    for (Index k = 0; k < 4; ++k, z *= t) own.col(2 * k) = z.real(), own.col(2 * k + 1) = z.imag();
  }
  for (const Index j : fit.missing) columns.row(j).setZero();
  return least_sum_squares(columns, fit.residual);
}

std::size_t strongest_mode(const DampedSinusoidsFit& fit, const DecayBand& band) {
  std::size_t best = 0;
  double most = -1;
  for (std::size_t m = 0; m < fit.poles.size(); ++m) {
    const bool mode = band.contains(fit.poles[m]) && fit.poles[m].imag() > fit.drift_up_to;
    const double energy = mode ? mode_energy(fit, m) : 0;
    if (energy > most) most = energy, best = m;
  }
  return best;
}

}  // namespace rigfit::signal
