#include "signal/sinusoids/decay_modes.h"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>

#include "signal/numerics/least_squares.h"
#include "signal/numerics/numbers.h"
#include "signal/sinusoids/decay_search.h"
#include "signal/sinusoids/subspace_poles.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
constexpr double kHighestDamping = 0.9;
constexpr Index kFewDegrees = 200;

class DecayModeSearch {
 public:
  DecayModeSearch(const DecaySamples& samples, const DecayBand& band,
                  const DecayModesOptions& options)
      : samples_(samples), options_(options), fitted_(fitted_band(band)), n_(samples.span) {}

  // The first mode, from several starts; nothing when no peak stands out of the noise.
  std::optional<DampedSinusoidsFit> first(std::optional<Complex> known) {
    const Eigen::VectorXd x = in_band(samples_.trendless());
    const double total = fit_of({}).residual_sum_squares;
    std::vector<Complex> starts;
    if (known) starts.push_back(*known);
    DecaySearchOptions search = searched();
    // Half of what noise may show: Fisher's test of the fit decides.
    search.energy_over_noise = 0.5 * threshold();
    const auto peaks = search_decays(x, search);
    for (const auto& c : peaks) {
      if (c.energy > 0.3 * peaks.front().energy) starts.push_back(c.pole);
    }
    // In a few cycles the spectrum tells little, noise included: there the fit decides.
    auto anywhere = peaks;
    if (peaks.empty()) {
      search.energy_over_noise = 0;
      anywhere = search_decays(x, search);
    }
    if (!anywhere.empty() && samples_.complete()) {
      for (const auto& c : few_cycle_starts(x, anywhere.front(), search)) starts.push_back(c.pole);
    }
    std::optional<DampedSinusoidsFit> best;
    for (const Complex start : starts) {
      auto fit = fit_of({start});
      if (!fit.usable() || !plausible_decay(fit.poles[0], n_) || !oscillates(fit)) continue;
      if (!passes_fisher(total - fit.residual_sum_squares, fit)) continue;
      if (!best || fit.residual_sum_squares < best->residual_sum_squares) best = std::move(fit);
    }
    return best;
  }

  // Long records are fitted up to half as far again as anything stands out of their noise.
  void within_what_stands_out(DampedSinusoidsFit& fit) {
    constexpr double kManyLines = 1 << 13;
    if (!samples_.complete() || (fitted_.high - fitted_.low) * static_cast<double>(n_) < kManyLines)
      return;
    DecaySearchOptions search = searched();
    search.energy_over_noise = threshold(), search.candidates = 64;
    double highest = fit.poles[0].imag() / kTwoPi;
    for (const auto& c : search_decays(fit.residual, search)) {
      highest = std::max(highest, (c.pole.imag() - 8 * c.pole.real()) / kTwoPi);
    }
    highest = std::max(1.5 * highest, fitted_.low + kManyLines / static_cast<double>(n_));
    if (highest >= fitted_.high) return;
    fitted_.high = highest;
    fit = fit_of(fit.poles);
  }

  // With an offset that decays, where it explains more than noise at low frequencies may.
  std::optional<DampedSinusoidsFit> relaxing(const DampedSinusoidsFit& fit) {
    if (fitted_.low * static_cast<double>(n_) > 3) return {};  // no offset in the band
    // Eight lines hold most of what an offset that decays leaves beside an offset and a drift.
    const LineSpectrum before = line_spectrum(fit.residual);
    const auto few = static_cast<Index>(8 * before.lines_per_cycle / static_cast<double>(n_));
    const double lowest = before.power.head(std::min(few, before.power.size())).sum() *
                          static_cast<double>(n_) / before.lines_per_cycle;
    if (!(lowest > threshold() * fit.variance())) return {};
    std::optional<DampedSinusoidsFit> best;
    for (const double constants : {1.0, 4.0, 16.0, 64.0}) {
      DampedSinusoidsOptions options = fitted_;
      options.relaxation = constants / static_cast<double>(n_);
      auto more = fit_damped_sinusoids(samples_, fit.poles, options);
      if (!more.usable()) continue;
      if (!best || more.residual_sum_squares < best->residual_sum_squares) best = std::move(more);
    }
    if (!best) return {};
    // A curve that falls over the whole stretch is drift; noise of the lowest lines is not white.
    const double gain = fit.residual_sum_squares - best->residual_sum_squares;
    const LineSpectrum left = line_spectrum(best->residual);
    const Index low = std::min<Index>(
        left.power.size(), static_cast<Index>(16 * left.lines_per_cycle / static_cast<double>(n_)));
    const double noise = std::max(best->variance(), 0.5 * left.power.head(low).mean());
    if (gain < threshold() * noise || !plausible_decay(best->poles[0], n_)) return {};
    fitted_.relaxation = best->relaxation;
    return best;
  }

  // One mode more, or nothing when none is worth it.
  std::optional<DampedSinusoidsFit> next(const DampedSinusoidsFit& fit) {
    DecaySearchOptions search = searched();
    search.energy_over_noise = threshold();
    for (const auto& candidate : search_decays(fit.residual, search)) {
      auto poles = fit.poles;
      poles.push_back(candidate.pole);
      auto more = fit_of(poles);
      if (more.usable() && worthwhile(fit, more, candidate.noise_variance)) return more;
    }
    return {};
  }

  // Two modes in place of the strongest where it leaves something that is smooth over a beat or
  // less, which no line of the residual shows: started by HTLS (subspace_poles.h).
  std::optional<DampedSinusoidsFit> split(const DampedSinusoidsFit& fit) {
    std::size_t m = 0;
    for (std::size_t k = 1; k < fit.poles.size(); ++k) {
      if (mode_energy(fit, k) > mode_energy(fit, m)) m = k;
    }
    const double noise = pair_evidence(fit.residual, fit.poles[m]);
    if (!(noise > 0)) return {};
    Eigen::VectorXd alone = fit.mode_signal(m) + fit.residual;
    const auto pair = pair_of_poles(alone, fit.poles[m]);
    if (pair.size() != 2) return {};
    std::vector<Complex> poles;
    for (std::size_t k = 0; k < fit.poles.size(); ++k) {
      if (k != m) poles.push_back(fit.poles[k]);
    }
    // The new one last, where `worthwhile` looks for it.
    const bool swap = std::abs(pair[0] - fit.poles[m]) > std::abs(pair[1] - fit.poles[m]);
    poles.push_back(pair[swap ? 1 : 0]), poles.push_back(pair[swap ? 0 : 1]);
    auto more = fit_of(poles);
    if (!more.usable() || !worthwhile(fit, more, noise)) return {};
    return more;
  }

 private:
  [[nodiscard]] double threshold() const {
    const double share = std::min(1.0, 2 * (fitted_.high - fitted_.low));
    return detection_threshold(static_cast<Index>(share * static_cast<double>(n_)),
                               options_.false_alarm);
  }
  [[nodiscard]] DecaySearchOptions searched() const {
    DecaySearchOptions search;
    search.lowest = fitted_.low, search.highest = fitted_.high, search.candidates = 3;
    search.band_low = fitted_.low, search.band_high = fitted_.high;
    return search;
  }
  [[nodiscard]] DampedSinusoidsFit fit_of(const std::vector<Complex>& poles) const {
    return fit_damped_sinusoids(samples_, poles, fitted_);
  }
  /// What is fitted, in time: complete samples only within the band.
  [[nodiscard]] Eigen::VectorXd in_band(const Eigen::VectorXd& x) const {
    if (!samples_.complete() || (fitted_.low <= 0 && fitted_.high >= 0.5)) return x;
    return fit_of({}).residual;
  }

  bool worthwhile(const DampedSinusoidsFit& fit, const DampedSinusoidsFit& more,
                  double noise_variance) const {
    const double gain = fit.residual_sum_squares - more.residual_sum_squares;
    if (!(gain > threshold() * noise_variance)) return false;
    // Few samples know little of the noise: Fisher's test as well.
    if (more.degrees < kFewDegrees && !passes_fisher(gain, more)) return false;
    const double white = more.residual_sum_squares / static_cast<double>(more.degrees);
    for (std::size_t m = 0; m < more.poles.size(); ++m) {
      if (!plausible_decay(more.poles[m], n_)) return false;
      const auto k = static_cast<Index>(4 * m);
      const double a_std = std::sqrt(white * more.unit_covariance(k + 2, k + 2));
      const double w_std = std::sqrt(white * more.unit_covariance(k + 3, k + 3));
      if (m + 1 < more.poles.size()) continue;  // held its ground before
      if (w_std > 0.05 * more.poles[m].imag()) return false;
      // Strongly damped ones explain transients as readily as modes: they must be well determined.
      if (damping_ratio_of(more.poles[m]) > 0.15 && a_std > 0.2 * std::abs(more.poles[m].real()))
        return false;
    }
    return told_apart(fit, more, noise_variance);
  }

  // Modes that beat for less than 0.4 beats while both last are not told apart; under one and a
  // half, one mode whose amplitude and phase depart from an exponential (t^2 and t^3: as many
  // parameters) must explain less than two do: half as much where the two leave something too, or
  // not more where they leave nothing but noise.
  bool told_apart(const DampedSinusoidsFit& fit, const DampedSinusoidsFit& more,
                  double noise_variance) const {
    for (std::size_t i = 0; i < more.poles.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        const double a = std::max(-more.poles[i].real(), -more.poles[k].real());
        const double both =
            a > 0 ? std::min(static_cast<double>(n_), 3 / a) : static_cast<double>(n_);
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

  static std::size_t nearest(const DampedSinusoidsFit& fit, Complex pole) {
    std::size_t best = 0;
    for (std::size_t m = 1; m < fit.poles.size(); ++m) {
      if (std::abs(fit.poles[m] - pole) < std::abs(fit.poles[best] - pole)) best = m;
    }
    return best;
  }

  // Whether noise of the residual's variance would take out so much with one mode more, in the best
  // of all cells of the bank, with probability `false_alarm` at most.
  bool passes_fisher(double gain, const DampedSinusoidsFit& fit) const {
    const double degrees = static_cast<double>(fit.degrees);
    const double ratio = gain / 4 / std::max(fit.residual_sum_squares / degrees, 1e-300);
    const double cells = std::exp(0.5 * threshold()) * options_.false_alarm;
    return gsl_cdf_fdist_Q(ratio, 4, degrees) * cells < options_.false_alarm;
  }

  // An arc is no oscillation: where few cycles are seen, the fit must leave less than half of what
  // a polynomial with as many coefficients leaves, or less by so much that noise would not show it.
  bool oscillates(const DampedSinusoidsFit& fit) const {
    const Complex p = fit.poles[0];
    const double lasts =
        p.real() < 0 ? std::min(static_cast<double>(n_), 3 / -p.real()) : static_cast<double>(n_);
    if (p.imag() / kTwoPi * lasts > 3) return true;
    Eigen::MatrixXd legendre(n_, 6);
    for (Index j = 0; j < n_; ++j) {
      const double t = n_ > 1 ? 2 * static_cast<double>(j) / static_cast<double>(n_ - 1) - 1 : 0;
      legendre(j, 0) = 1, legendre(j, 1) = t;
      for (int k = 2; k < 6; ++k) {
        legendre(j, k) = ((2 * k - 1) * t * legendre(j, k - 1) - (k - 1) * legendre(j, k - 2)) / k;
      }
    }
    const Eigen::VectorXd x = fit.residual + fit.mode_signal(0);
    Eigen::VectorXd present = Eigen::VectorXd::Ones(n_);
    for (Index j = 0; j < n_; ++j) {
      if (fit.residual(j) == 0) legendre.row(j).setZero(), present(j) = 0;
    }
    const double left = fit.residual_sum_squares;
    const double polynomial = least_squares(legendre, x.cwiseProduct(present)).left_sum_squares[0];
    return left < 0.5 * polynomial ||
           polynomial - left > threshold() * left / static_cast<double>(fit.degrees);
  }

  const DecaySamples& samples_;
  const DecayModesOptions& options_;
  DampedSinusoidsOptions fitted_;
  Index n_;
};

}  // namespace

bool DecayBand::contains(Complex pole) const {
  const double f = std::abs(pole) / kTwoPi;
  return all || (f >= low && f <= high);
}

bool plausible_decay(Complex pole, Index samples) {
  const double cycles = pole.imag() / kTwoPi * static_cast<double>(samples);
  return damping_ratio_of(pole) < kHighestDamping && cycles > 0.3 &&
         pole.real() * static_cast<double>(samples) < 2.9;
}

double damping_ratio_of(Complex pole) { return -pole.real() / std::abs(pole); }

double mode_energy(const DampedSinusoidsFit& fit, std::size_t m) {
  return fit.mode_signal(m).squaredNorm();
}

DampedSinusoidsOptions fitted_band(const DecayBand& band) {
  DampedSinusoidsOptions options;
  if (band.all) return options;
  const double beside = 0.25 * (band.high - band.low);
  options.low = std::max(0.0, band.low - beside);
  options.high = std::min(0.5, band.high + beside);
  return options;
}

std::optional<DampedSinusoidsFit> find_decay_modes(const DecaySamples& samples,
                                                   const DecayBand& band,
                                                   const DecayModesOptions& options,
                                                   std::optional<Complex> start) {
  DecayModeSearch search(samples, band, options);
  auto fit = search.first(start);
  if (!fit) return fit;
  search.within_what_stands_out(*fit);
  if (options.relaxing) {
    if (auto more = search.relaxing(*fit)) fit = std::move(more);
  }
  const auto limit = static_cast<std::size_t>(std::max(1, options.max_modes));
  while (fit->poles.size() < limit * (band.all ? 1 : 2)) {
    auto more = search.next(*fit);
    if (!more) more = search.split(*fit);
    if (!more) break;
    fit = std::move(more);
  }
  return fit;
}

double departing_residual(const DampedSinusoidsFit& fit, std::span<const std::size_t> modes) {
  const auto n = fit.samples;
  Eigen::MatrixXd columns(n, 8 * static_cast<Index>(modes.size()));
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const Complex pole = fit.poles[modes[m]];
    auto own = columns.middleCols<8>(8 * static_cast<Index>(m));
    for (Index j = 0; j < n; ++j) {
      const double t = static_cast<double>(j) / static_cast<double>(n);
      const Complex z = std::exp(pole * static_cast<double>(j));
      double power = 1;
      for (Index k = 0; k < 4; ++k) {
        own(j, 2 * k) = power * z.real(), own(j, 2 * k + 1) = power * z.imag();
        power *= t;
      }
    }
  }
  for (Index j = 0; j < n; ++j) {
    if (fit.residual(j) == 0) columns.row(j).setZero();  // missing
  }
  return least_squares(columns, fit.residual).left_sum_squares[0];
}

std::size_t strongest_mode(const DampedSinusoidsFit& fit, const DecayBand& band) {
  std::size_t best = 0;
  double most = -1;
  for (std::size_t m = 0; m < fit.poles.size(); ++m) {
    const double energy = band.contains(fit.poles[m]) ? mode_energy(fit, m) : 0;
    if (energy > most) most = energy, best = m;
  }
  return best;
}

}  // namespace rigfit::signal
