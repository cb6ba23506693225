#include "signal/variation/hit_scatter.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>

#include "signal/estimation/robust.h"
#include "signal/numerics/numbers.h"
#include "signal/refinement/local_fit.h"
#include "signal/variation/mode_changes.h"

namespace rigfit::signal {
namespace {
using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;

constexpr Index kBackground = 3;   // coefficients of the polynomial
constexpr double kBandwidths = 6;  // half width of the window, half bandwidths of the mode
constexpr Index kLines = 8;        // and at least so many lines on either side
// Poles nearer than so many times the sum of their half bandwidths are fitted together: where a
// neighbour is one part in 20 of its peak.
constexpr double kOverlap = 4.5;
/// Decay rate over the line spacing, of a half left at the end of a record.
constexpr double kSteady = 0.693;
/// Least peak of a neighbour in hits, of its peak in the average, both over the mode's.
constexpr double kLeastPeak = 1.0 / 3;

/// Lines around a mode and the poles that share them.
struct Window {
  VectorXcd s;
  Index first = 0;
  std::vector<std::size_t> near;    ///< modes whose resonances overlap with it: followed as well
  std::vector<Complex> neighbours;  ///< further ones, held
};

/// Mean over the hits of the variance of the real and of the imaginary part of a pole, each: from
/// noise that is white over lines, and from what is left line by line.
struct PoleNoise {
  double white = 0, robust = 0;
};

/// All hits with one set of free poles, the first of them the mode's.
struct HitFits {
  std::vector<std::vector<Complex>> by_input;
  std::vector<std::vector<std::size_t>> hit;
  PoleNoise noise;
  /// Sum over hits and FRFs of the misfit over the noise, and what it has in degrees of freedom.
  double misfit = 0, freedom = 0;
  /// Peak of each other free pole over the mode's, by hit.
  std::vector<std::vector<double>> peaks;
  int fits = 0;
};

std::optional<Window> window_around(const FrfSet& frfs, const ModalModel& model, std::size_t mode) {
  const Index lines = std::min(frfs.frequency_hz.size(), frfs.by_hit.front().rows());
  if (lines < 2) return {};
  const double decay = frfs.exponential_decay_rate_1_s;
  const double spacing =
      (frfs.frequency_hz[lines - 1] - frfs.frequency_hz[0]) / static_cast<double>(lines - 1);
  const Complex pole = model.modes[mode].pole_rad_s;
  const double centre = pole.imag() / kTwoPi;
  const double half = std::max(kBandwidths * (decay - pole.real()) / kTwoPi,
                               (static_cast<double>(kLines) + 0.5) * spacing);
  Window window;
  Index last = 0;
  for (Index k = 0; k < lines; ++k) {
    const double f = frfs.frequency_hz[k];
    if (!(f > 0) || f < centre - half) window.first = k + 1;
    if (f <= centre + half) last = k + 1;
  }
  for (std::size_t r = 0; r < model.modes.size(); ++r) {
    const Complex other = model.modes[r].pole_rad_s;
    const double apart = std::abs(other.imag() - pole.imag());
    if (r == mode || apart / kTwoPi > 1.5 * half) continue;
    // A tone that lasts for the record has one frequency in all hits.
    const bool steady = decay - other.real() < kSteady * spacing;
    if (!steady && apart < kOverlap * (2 * decay - other.real() - pole.real()) &&
        apart / kTwoPi < half) {
      window.near.push_back(r);
    } else {
      window.neighbours.push_back(other);
    }
  }
  const Index count = last - window.first;
  const auto poles = static_cast<Index>(1 + window.near.size() + window.neighbours.size());
  if (count < kLines + kBackground + 1 + poles) return {};
  window.s.resize(count);
  for (Index k = 0; k < count; ++k) {
    window.s[k] = Complex(decay, kTwoPi * frfs.frequency_hz[window.first + k]);
  }
  return window;
}

/// One over the variance of each FRF's noise, from what a fit leaves; rounding, where nothing is
/// left.
Eigen::VectorXd weights_of(const LocalFit& fit, const MatrixXcd& H) {
  const Eigen::VectorXd power = H.colwise().squaredNorm().transpose();
  const Eigen::VectorXd least = 1e-24 * power / static_cast<double>(H.rows());
  const Eigen::VectorXd variance = (fit.misfit / static_cast<double>(fit.freedom)).cwiseMax(least);
  return (power.array() > 0).select(variance.cwiseMax(1e-300).cwiseInverse(), 0.0);
}

/// The poles that the FRFs `H` (lines of the window x responses) share; not usable when the first
/// does not stand. `weight`: of the responses, empty: from what the fit leaves.
LocalFit fit_hit(const Window& window, const MatrixXcd& H, const VectorXcd& start,
                 Eigen::VectorXd& weight) {
  LocalFitOptions options;
  options.background_order = static_cast<int>(kBackground) - 1;
  const VectorXcd fixed = Eigen::Map<const VectorXcd>(window.neighbours.data(),
                                                      static_cast<Index>(window.neighbours.size()));
  const bool weighted = weight.size() > 0;
  const Eigen::VectorXd power = H.colwise().squaredNorm().transpose();
  if (!weighted) weight = (power.array() > 0).select(power.cwiseMax(1e-300).cwiseInverse(), 0.0);
  for (int round = weighted ? 1 : 0; round < 2; ++round) {
    LocalFit fit = fit_locally(window.s, H, weight, start, fixed, options);
    if (!fit.usable ||
        std::abs(fit.poles[0] - start[0]) > 3 * (window.s[0].real() - start[0].real())) {
      fit.usable = false;
      return fit;
    }
    if (round == 1) return fit;
    weight = weights_of(fit, H);
  }
  return {};
}

/// Every hit with the poles `start` free. `weights`: of every hit's responses, filled where empty.
HitFits fit_hits(const FrfSet& frfs, const Window& window, const VectorXcd& start,
                 std::vector<Eigen::VectorXd>& weights) {
  const auto inputs = frfs.inputs.size(), responses = frfs.responses.size();
  HitFits all;
  all.by_input.resize(inputs);
  all.hit.resize(inputs);
  all.peaks.resize(static_cast<std::size_t>(start.size() - 1));
  weights.resize(inputs * frfs.by_hit.size());
  for (std::size_t i = 0; i < inputs; ++i) {
    for (std::size_t h = 0; h < frfs.by_hit.size(); ++h) {
      MatrixXcd H(window.s.size(), static_cast<Index>(responses));
      for (std::size_t o = 0; o < responses; ++o) {
        const Index column = frfs.column(static_cast<Index>(o), static_cast<Index>(i));
        H.col(static_cast<Index>(o)) = frfs.by_hit[h].col(column).segment(window.first, H.rows());
      }
      if (!H.allFinite()) continue;
      Eigen::VectorXd& weight = weights[i * frfs.by_hit.size() + h];
      const LocalFit fit = fit_hit(window, H, start, weight);
      if (!fit.usable) continue;
      all.by_input[i].push_back(fit.poles[0]);
      all.hit[i].push_back(h);
      all.noise.white += 0.5 * fit.covariance(0, 0).real();
      all.noise.robust += 0.5 * fit.robust_covariance(0, 0).real();
      const Eigen::ArrayXd peaks =
          fit.amplitudes.rowwise().norm().array() / (window.s[0].real() - fit.poles.real().array());
      for (Index q = 1; q < start.size(); ++q) {
        all.peaks[static_cast<std::size_t>(q - 1)].push_back(peaks[q] / peaks[0]);
      }
      all.misfit += 2 * weight.dot(fit.misfit);
      all.freedom += 2 * static_cast<double>(fit.freedom * (weight.array() > 0).count()) -
                     2 * static_cast<double>(start.size());
      ++all.fits;
    }
  }
  all.noise.white /= std::max(1, all.fits);
  all.noise.robust /= std::max(1, all.fits);
  return all;
}

/// Fits of a mode together with those neighbours that the hits show. A neighbour counts if leaving
/// out its pole and residues raises the misfit by more than noise does (one chance in 10^4), if the
/// hits' noise lets the two poles be told apart, and if its peak over the mode's is at least a
/// third of its share in the average. One mode that moves looks like two in the average; the hits
/// show next to nothing of the second.
HitFits follow(const FrfSet& frfs, const ModalModel& model, std::size_t mode, double shared,
               Window& window, std::vector<std::size_t>& unseen) {
  const auto peak_of = [&](std::size_t r) {
    const IdentifiedMode& of = model.modes[r];
    return of.shape.norm() * of.participation.norm() /
           (frfs.exponential_decay_rate_1_s - of.pole_rad_s.real());
  };
  const auto start_of = [&](const std::vector<std::size_t>& near) {
    VectorXcd start(static_cast<Index>(1 + near.size()));
    start[0] = model.modes[mode].pole_rad_s;
    for (std::size_t q = 0; q < near.size(); ++q) {
      start[static_cast<Index>(q + 1)] = model.modes[near[q]].pole_rad_s;
    }
    return start;
  };
  for (;;) {
    std::vector<Eigen::VectorXd> weights;
    HitFits full = fit_hits(frfs, window, start_of(window.near), weights);
    double largest = 1e-4;
    std::size_t least = window.near.size();
    HitFits instead;
    for (std::size_t q = 0; q < window.near.size(); ++q) {
      std::vector<std::size_t> fewer = window.near;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(q));
      HitFits without = fit_hits(frfs, window, start_of(fewer), weights);
      // A hit that stands with fewer poles only tells for fewer.
      const double added = without.freedom - full.freedom;
      const bool shown =
          full.fits > 0 && full.fits >= without.fits && added > 0 &&
          median(full.peaks[q]) > kLeastPeak * peak_of(window.near[q]) / peak_of(mode);
      const double chance =
          !shown ? 1
                 : gsl_cdf_chisq_Q(std::max(0.0, without.misfit - full.misfit) / shared,
                                   added / shared);
      if (chance > largest) largest = chance, least = q;
    }
    if (least == window.near.size()) return full;
    unseen.push_back(window.near[least]);
    window.near.erase(window.near.begin() + static_cast<std::ptrdiff_t>(least));
  }
}

/// Pooled scatter of repetitions.
struct Scatter {
  double variance = 0, freedom = 0, mean = 0;
  int count = 0;
};

Scatter scatter_of(const std::vector<std::vector<double>>& points) {
  Scatter all;
  for (const std::vector<double>& values : points) {
    if (values.empty()) continue;
    double mean = 0;
    for (const double v : values) mean += v / static_cast<double>(values.size());
    for (const double v : values) all.variance += (v - mean) * (v - mean);
    all.freedom += static_cast<double>(values.size()) - 1;
    all.count += static_cast<int>(values.size());
    all.mean += mean * static_cast<double>(values.size());
  }
  all.mean /= std::max(1, all.count);
  all.variance /= std::max(1.0, all.freedom);
  return all;
}

/// Such that +-1.96 of it hold 95 %.
double widened(double std, double freedom) {
  return std * gsl_cdf_tdist_Pinv(0.975, freedom) / 1.96;
}
double widened_std(const Scatter& scatter) {  // std of the mean
  return widened(std::sqrt(scatter.variance / scatter.count), scatter.freedom);
}

/// Modes whose single hits show the same pole twice: the weaker one is doubtful.
void mark_doubles(const std::vector<Scatter>& frequency, const std::vector<bool>& allowed,
                  ModalModel& model) {
  for (std::size_t r = 0; r < model.modes.size(); ++r) {
    for (std::size_t q = r + 1; q < model.modes.size(); ++q) {
      const Scatter &a = frequency[r], &b = frequency[q];
      if (!allowed[r] || !allowed[q] || a.count == 0 || b.count == 0) continue;
      const double apart = std::abs(a.mean - b.mean);
      const double one = std::sqrt(std::max(a.variance, b.variance));
      const double width =
          0.1 * model.modes[r].damping_ratio.value * model.modes[r].frequency_hz.value;
      if (apart > std::max(one, width)) continue;
      const bool first = model.modes[r].shape.norm() < model.modes[q].shape.norm();
      add_doubt(model.modes[first ? r : q],
                fmt::format("single hits show one resonance at {:.5g} Hz, not two", a.mean));
    }
  }
}

double chance_of(double ratio, double freedom, double noise_freedom) {
  return gsl_cdf_fdist_Q(ratio, freedom, std::max(1.0, noise_freedom));
}

/// Variances of frequency and damping ratio between hits over those of noise: of the average by
/// its own fit, where that is known, else of single hits.
struct OverNoise {
  double frequency = 0, damping = 0, freedom = 0;
  double white_part = 1;
};

OverNoise over_noise(const ModeOfHits& hits, const Scatter& f, const Scatter& z,
                     const IdentifiedMode& mode) {
  const auto squared = [](double a, double b) { return a / b * (a / b); };
  const JackknifeOfHits& average = hits.average;
  if (average.freedom > 0 && mode.frequency_hz.std > 0 && mode.damping_ratio.std > 0) {
    return {squared(average.frequency_std_hz, mode.frequency_hz.std),
            squared(average.damping_ratio_std, mode.damping_ratio.std), average.freedom, 1};
  }
  return {f.variance / std::pow(hits.noise_frequency_hz, 2),
          z.variance / std::pow(hits.noise_damping_ratio, 2), f.freedom, hits.white_part};
}

/// What the scatter of all modes says.
struct Verdict {
  std::vector<Scatter> frequency, damping;
  bool all_differ = false;              ///< beyond what is left line by line
  bool all_scatter = false;             ///< beyond noise that is white over lines
  std::vector<bool> differs, scatters;  ///< by mode
  double largest = 0, times = 0;        ///< relative scatter, and over that of noise
};

Verdict verdict_on(const std::vector<ModeOfHits>& hits, const ModalModel& model) {
  Verdict verdict;
  double excess = 0, white_excess = 0, freedom = 0, noise_freedom = 0;
  for (std::size_t r = 0; r < hits.size(); ++r) {
    verdict.frequency.push_back(scatter_of(hits[r].frequency_hz));
    verdict.damping.push_back(scatter_of(hits[r].damping_ratio));
    const Scatter &f = verdict.frequency.back(), &z = verdict.damping.back();
    if (!(f.freedom > 0) || !(hits[r].noise_frequency_hz > 0)) continue;
    const OverNoise over = over_noise(hits[r], f, z, model.modes[r]);
    excess += over.freedom * over.frequency;
    white_excess += over.freedom * over.frequency / over.white_part;
    freedom += over.freedom;
    noise_freedom += hits[r].noise_freedom;
  }
  verdict.differs.assign(hits.size(), false);
  verdict.scatters = verdict.differs;
  if (!(freedom > 0)) return verdict;
  constexpr double kAll = 0.01;
  verdict.all_differ = chance_of(excess / freedom, freedom, noise_freedom) < kAll;
  verdict.all_scatter = chance_of(white_excess / freedom, freedom, noise_freedom) < kAll;
  return verdict;
}

/// Fills `between_hits` of a mode and what the verdict says of it.
void judge_mode(const ModeOfHits& hits, std::size_t r, IdentifiedMode& mode, Verdict& verdict) {
  constexpr double kMode = 0.05;
  const Scatter &f = verdict.frequency[r], &z = verdict.damping[r];
  if (!(f.freedom > 0) || !(hits.noise_frequency_hz > 0)) return;
  const double f_noise = std::pow(hits.noise_frequency_hz, 2);
  const double z_noise = std::pow(hits.noise_damping_ratio, 2);
  const OverNoise over = over_noise(hits, f, z, mode);
  const double ratio = 0.5 * (over.frequency + over.damping);
  const auto beyond = [&](double times) {
    return chance_of(times, 2 * over.freedom, hits.noise_freedom) < kMode;
  };
  const bool differs = verdict.all_differ || beyond(ratio);
  verdict.differs[r] = differs;
  verdict.scatters[r] = verdict.all_scatter || differs || beyond(ratio / over.white_part);
  mode.between_hits = {f.count, std::sqrt(std::max(0.0, f.variance - f_noise)),
                       std::sqrt(std::max(0.0, z.variance - z_noise)), differs};
  const double part = mode.between_hits.frequency_std_hz / mode.frequency_hz.value;
  if (differs && part > verdict.largest) {
    verdict.largest = part;
    verdict.times = std::sqrt(f.variance / f_noise);
  }
}

/// Whether the mean over the hits is to be taken: where the average's damping is biased by more
/// than half a standard deviation.
bool average_is_biased(const Scatter& damping, const IdentifiedMode& mode) {
  // Poles that scatter by s about i w widen the average's resonance by (s / decay rate)^2.
  const double decay_rate = mode.damping_ratio.value * std::abs(mode.pole_rad_s);
  const double widening = mode.damping_ratio.value *
                          std::pow(kTwoPi * mode.between_hits.frequency_std_hz / decay_rate, 2);
  return widening > 0.5 * std::max(mode.damping_ratio.std, widened_std(damping));
}

/// Raises the standard deviations of a mode to those that the hits give.
void widen_to_hits(double f_std, double z_std, std::size_t r, ModalModel& model) {
  IdentifiedMode& mode = model.modes[r];
  const double before = mode.frequency_hz.std, damping_before = mode.damping_ratio.std;
  const auto row = static_cast<Index>(2 * r);
  set_std(mode.frequency_hz, row, std::max(before, f_std), model.pole_covariance);
  set_std(mode.damping_ratio, row + 1, std::max(damping_before, z_std), model.pole_covariance);
  // Errors of residues go with those of the poles.
  if (before > 0 && damping_before > 0) {
    mode.shape_std *=
        std::max(mode.frequency_hz.std / before, mode.damping_ratio.std / damping_before);
  }
}

}  // namespace

std::vector<ModeOfHits> modes_of_hits(const FrfSet& frfs, const ModalModel& model) {
  std::vector<ModeOfHits> result(model.modes.size());
  if (frfs.by_hit.size() < 2) return result;
  const double spacing_s =
      frfs.frequency_hz.size() > 1 ? 1 / (frfs.frequency_hz[1] - frfs.frequency_hz[0]) : 0;
  // Under an exponential window neighbouring lines share their noise: sum of |correlation|^2.
  const double c = frfs.exponential_decay_rate_1_s * spacing_s;
  const double shared = c > 1e-6 ? c / std::tanh(c) : 1;
  for (std::size_t r = 0; r < model.modes.size(); ++r) {
    auto window = window_around(frfs, model, r);
    if (!window) continue;
    ModeOfHits& mode = result[r];
    const HitFits fits = follow(frfs, model, r, shared, *window, mode.unseen);
    mode.hit = fits.hit;
    for (const std::vector<Complex>& poles : fits.by_input) {
      mode.frequency_hz.emplace_back();
      mode.damping_ratio.emplace_back();
      for (const Complex pole : poles) {
        mode.frequency_hz.back().push_back(std::abs(pole) / kTwoPi);
        mode.damping_ratio.back().push_back(-pole.real() / std::abs(pole));
      }
    }
    if (fits.fits == 0) continue;
    const double omega = std::abs(model.modes[r].pole_rad_s);
    const double variance = shared * std::max(fits.noise.white, fits.noise.robust);
    mode.white_part = std::min(1.0, shared * fits.noise.white / variance);
    mode.noise_frequency_hz = std::sqrt(variance) / kTwoPi;
    mode.noise_damping_ratio = std::sqrt(variance) / omega;
    mode.noise_freedom = fits.freedom / shared;
  }
  return result;
}

void allow_for_hits(const FrfSet& frfs, const std::vector<ModeOfHits>& hits, ModalModel& model) {
  if (frfs.by_hit.size() < 2 || hits.size() != model.modes.size()) return;
  Verdict verdict = verdict_on(hits, model);
  for (std::size_t r = 0; r < hits.size(); ++r) {
    const auto shown = static_cast<std::size_t>(verdict.frequency[r].count);
    const std::size_t fits = hits[r].frequency_hz.size() * frfs.by_hit.size();
    if (verdict.all_differ && fits > 0 && 2 * shown <= fits) {
      add_doubt(model.modes[r], fmt::format("only {} of {} single hits show it", shown, fits));
    }
    judge_mode(hits[r], r, model.modes[r], verdict);
  }
  mark_doubles(verdict.frequency, verdict.scatters, model);
  bool means = false;
  for (std::size_t r = 0; r < hits.size(); ++r) {
    if (!verdict.scatters[r]) continue;
    IdentifiedMode& mode = model.modes[r];
    const Scatter &f = verdict.frequency[r], &z = verdict.damping[r];
    // Where hits do not show a sure neighbour, their fits of this mode take its share too.
    const bool takes_more =
        std::any_of(hits[r].unseen.begin(), hits[r].unseen.end(),
                    [&](std::size_t other) { return !model.modes[other].doubtful; });
    const JackknifeOfHits& average = hits[r].average;
    const bool biased =
        verdict.differs[r] && frfs.inputs.size() == 1 && !takes_more && average_is_biased(z, mode);
    if (biased) {
      means = true;
      set_frequency_and_damping(mode, f.mean, z.mean, frfs.exponential_decay_rate_1_s);
    }
    // Where two poles share one resonance the average's filter tells little.
    double f_std = widened_std(f), z_std = widened_std(z);
    if (!biased && average.freedom > 0) {
      f_std = std::max(f_std, widened(average.frequency_std_hz, average.freedom));
      z_std = std::max(z_std, widened(average.damping_ratio_std, average.freedom));
    }
    widen_to_hits(f_std, z_std, r, model);
  }
  if (!verdict.all_differ) return;
  model.notes.push_back(
      {"hits_disagree",
       fmt::format(
           "frequencies differ from hit to hit by up to {:.2g} % (one standard deviation), "
           "{:.1f} times what noise gives: the structure, the hammer or the place struck "
           "changes; {}error bars are those of the scatter between hits",
           100 * verdict.largest, verdict.times,
           means ? "values are means over the hits where the average would be biased, " : ""),
       ""});
}

}  // namespace rigfit::signal
