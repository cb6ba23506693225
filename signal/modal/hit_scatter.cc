#include "signal/modal/hit_scatter.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>

#include "signal/numerics/numbers.h"

namespace rigfit::signal {
namespace {
using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;

constexpr Index kBackground = 3;   // coefficients of the polynomial
constexpr double kBandwidths = 6;  // half width of the window, half bandwidths of the mode
constexpr Index kLines = 8;        // and at least so many lines on either side

/// Lines around a mode and the poles that share them.
struct Window {
  VectorXcd s;
  Eigen::VectorXd x;  ///< -1..1
  Index first = 0;
  std::vector<Complex> neighbours;
};

struct HitPole {
  Complex pole;
  double variance = 0;  ///< of its real and of its imaginary part, each
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
    if (r == mode || std::abs(other.imag() / kTwoPi - centre) > 1.5 * half) continue;
    // Within the resonance: a peak that moves between hits looks like two in the average. Where it
    // is another mode, one pole leaves a misfit, which counts as noise.
    if (std::abs(other.imag() - pole.imag()) < 2 * decay - other.real() - pole.real()) continue;
    window.neighbours.push_back(other);
  }
  const Index count = last - window.first;
  if (count < kLines + kBackground + 2 + static_cast<Index>(window.neighbours.size())) return {};
  window.s.resize(count);
  window.x.resize(count);
  for (Index k = 0; k < count; ++k) {
    const double f = frfs.frequency_hz[window.first + k];
    window.s[k] = Complex(decay, kTwoPi * f);
    window.x[k] = (f - centre) / half;
  }
  return window;
}

/// The pole that the FRFs `H` (lines of the window x responses) share; empty when it does not
/// stand.
std::optional<HitPole> fit_hit(const Window& window, const MatrixXcd& H, Complex pole) {
  constexpr int kSteps = 20;
  const Complex start = pole;
  const Index lines = window.s.size();
  const auto others = static_cast<Index>(window.neighbours.size());
  const Index unknowns = 2 + others + kBackground;
  for (int step = 0; step < kSteps; ++step) {
    const double width = window.s[0].real() - pole.real();
    if (!(width > 0)) return {};
    MatrixXcd basis(lines, unknowns);
    basis.col(0) = width * (window.s.array() - pole).inverse();
    basis.col(1) = basis.col(0).array().square();
    for (Index r = 0; r < others; ++r) {
      const Complex other = window.neighbours[static_cast<std::size_t>(r)];
      basis.col(2 + r) = (window.s[0].real() - other.real()) * (window.s.array() - other).inverse();
    }
    basis.col(2 + others).setOnes();
    basis.col(3 + others) = window.x.cast<Complex>();
    basis.col(4 + others) = window.x.array().square().cast<Complex>();
    const Eigen::HouseholderQR<MatrixXcd> qr(basis);
    const MatrixXcd coefficients = qr.solve(H);
    const MatrixXcd residual = H - basis * coefficients;
    // |row 1 of (basis' basis)^-1/2|^2: variance of b for unit noise.
    const MatrixXcd triangle = qr.matrixQR().topRows(unknowns).triangularView<Eigen::Upper>();
    const VectorXcd row = triangle.adjoint().triangularView<Eigen::Lower>().solve(
        VectorXcd(VectorXcd::Unit(unknowns, 1)));
    double information = 0;
    Complex shift = 0;
    for (Index c = 0; c < H.cols(); ++c) {
      const double left = residual.col(c).squaredNorm() / static_cast<double>(lines - unknowns);
      if (!(H.col(c).squaredNorm() > 0)) continue;
      // Rounding, where nothing is left.
      const double variance =
          std::max(left, 1e-24 * H.col(c).squaredNorm() / static_cast<double>(lines));
      information += std::norm(coefficients(0, c)) / variance;
      shift += std::conj(coefficients(0, c)) * coefficients(1, c) / variance;
    }
    if (!(information > 0) || !std::isfinite(information)) return {};
    shift *= width / information;
    const double variance = 0.5 * width * width * row.squaredNorm() / information;
    const double most = 0.5 * width;
    if (std::abs(shift) > most) shift *= most / std::abs(shift);
    pole += shift;
    if (std::abs(pole - start) > 3 * (window.s[0].real() - start.real())) return {};
    if (std::norm(shift) < 1e-4 * variance || std::abs(shift) < 1e-9 * width) {
      return HitPole{pole, variance};
    }
  }
  return {};
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

/// Of the mean, such that +-1.96 of it hold 95 %.
double widened_std(const Scatter& scatter) {
  return std::sqrt(scatter.variance / scatter.count) * gsl_cdf_tdist_Pinv(0.975, scatter.freedom) /
         1.96;
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
      IdentifiedMode& weaker = model.modes[first ? r : q];
      weaker.doubtful = true;
      weaker.doubt += fmt::format("{}single hits show one resonance at {:.5g} Hz, not two",
                                  weaker.doubt.empty() ? "" : "; ", a.mean);
    }
  }
}

double chance_of(double ratio, double freedom, double noise_freedom) {
  return gsl_cdf_fdist_Q(ratio, freedom, std::max(1.0, noise_freedom));
}

/// Whether a sure mode within four bandwidths of mode r is one that half of the `fits` single hits
/// or fewer show: their fits of mode r then take its share too.
bool hidden_neighbour(const std::vector<IdentifiedMode>& modes, std::size_t r,
                      const std::vector<Scatter>& frequency, std::size_t fits) {
  for (const std::size_t other : {r - 1, r + 1}) {  // r - 1 wraps below 0 and is left out
    if (other >= modes.size() || modes[other].doubtful) continue;
    const Complex p = modes[r].pole_rad_s, q = modes[other].pole_rad_s;
    const bool near = std::abs(p.imag() - q.imag()) < -4 * (p.real() + q.real());
    if (near && 2 * static_cast<std::size_t>(frequency[other].count) <= fits) return true;
  }
  return false;
}

}  // namespace

std::vector<ModeOfHits> modes_of_hits(const FrfSet& frfs, const ModalModel& model) {
  std::vector<ModeOfHits> result(model.modes.size());
  if (frfs.by_hit.size() < 2) return result;
  const auto inputs = frfs.inputs.size(), responses = frfs.responses.size();
  const double spacing_s =
      frfs.frequency_hz.size() > 1 ? 1 / (frfs.frequency_hz[1] - frfs.frequency_hz[0]) : 0;
  // Under an exponential window neighbouring lines share their noise: sum of |correlation|^2.
  const double c = frfs.exponential_decay_rate_1_s * spacing_s;
  const double shared = c > 1e-6 ? c / std::tanh(c) : 1;
  for (std::size_t r = 0; r < model.modes.size(); ++r) {
    const auto window = window_around(frfs, model, r);
    if (!window) continue;
    ModeOfHits& mode = result[r];
    mode.frequency_hz.resize(inputs);
    mode.damping_ratio.resize(inputs);
    double variance = 0, count = 0;
    for (std::size_t i = 0; i < inputs; ++i) {
      for (const MatrixXcd& all : frfs.by_hit) {
        MatrixXcd H(window->s.size(), static_cast<Index>(responses));
        for (std::size_t o = 0; o < responses; ++o) {
          const Index column = frfs.column(static_cast<Index>(o), static_cast<Index>(i));
          H.col(static_cast<Index>(o)) = all.col(column).segment(window->first, H.rows());
        }
        if (!H.allFinite()) continue;
        const auto pole = fit_hit(*window, H, model.modes[r].pole_rad_s);
        if (!pole) continue;
        mode.frequency_hz[i].push_back(std::abs(pole->pole) / kTwoPi);
        mode.damping_ratio[i].push_back(-pole->pole.real() / std::abs(pole->pole));
        variance += shared * pole->variance, ++count;
      }
    }
    if (count == 0) continue;
    const double omega = std::abs(model.modes[r].pole_rad_s);
    mode.noise_frequency_hz = std::sqrt(variance / count) / kTwoPi;
    mode.noise_damping_ratio = std::sqrt(variance / count) / omega;
    mode.noise_freedom = 2 * count * static_cast<double>(responses) *
                         static_cast<double>(window->s.size() - kBackground - 2 -
                                             static_cast<Index>(window->neighbours.size())) /
                         shared;
  }
  return result;
}

void allow_for_hits(const FrfSet& frfs, ModalModel& model) {
  if (frfs.by_hit.size() < 2 || model.modes.empty()) return;
  const std::vector<ModeOfHits> hits = modes_of_hits(frfs, model);
  std::vector<Scatter> frequency, damping;
  double excess = 0, freedom = 0, noise_freedom = 0;
  for (const ModeOfHits& mode : hits) {
    frequency.push_back(scatter_of(mode.frequency_hz));
    damping.push_back(scatter_of(mode.damping_ratio));
    const Scatter& f = frequency.back();
    if (!(f.freedom > 0) || !(mode.noise_frequency_hz > 0)) continue;
    excess += f.freedom * f.variance / std::pow(mode.noise_frequency_hz, 2);
    freedom += f.freedom;
    noise_freedom += mode.noise_freedom;
  }
  if (!(freedom > 0)) return;
  constexpr double kMode = 0.05, kAll = 0.01;
  const bool all_differ = chance_of(excess / freedom, freedom, noise_freedom) < kAll;
  double largest = 0, times = 0;
  bool means = false;
  const std::vector<IdentifiedMode> before = model.modes;
  std::vector<bool> allowed(hits.size(), false);
  for (std::size_t r = 0; r < hits.size(); ++r) {
    IdentifiedMode& mode = model.modes[r];
    const Scatter &f = frequency[r], &z = damping[r];
    const std::size_t fits = hits[r].frequency_hz.size() * frfs.by_hit.size();
    if ((all_differ || frfs.shared_force_noise) && fits > 0 &&
        2 * static_cast<std::size_t>(f.count) <= fits) {
      mode.doubtful = true;
      mode.doubt += fmt::format("{}only {} of {} single hits show it",
                                mode.doubt.empty() ? "" : "; ", f.count, fits);
    }
    if (!(f.freedom > 0) || !(hits[r].noise_frequency_hz > 0)) continue;
    const double f_noise = std::pow(hits[r].noise_frequency_hz, 2);
    const double z_noise = std::pow(hits[r].noise_damping_ratio, 2);
    const double ratio = 0.5 * (f.variance / f_noise + z.variance / z_noise);
    const bool differs =
        all_differ || chance_of(ratio, 2 * f.freedom, hits[r].noise_freedom) < kMode;
    mode.between_hits = {f.count, std::sqrt(std::max(0.0, f.variance - f_noise)),
                         std::sqrt(std::max(0.0, z.variance - z_noise)), differs};
    if (!differs && !frfs.shared_force_noise) continue;
    allowed[r] = true;
    // Poles that scatter by s about i w widen the average's resonance by (s / decay rate)^2.
    const double decay_rate = mode.damping_ratio.value * std::abs(mode.pole_rad_s);
    const double widening = mode.damping_ratio.value *
                            std::pow(kTwoPi * mode.between_hits.frequency_std_hz / decay_rate, 2);
    const double std = std::max(mode.damping_ratio.std, widened_std(z));
    if (frfs.inputs.size() == 1 && !hidden_neighbour(before, r, frequency, fits) &&
        (frfs.shared_force_noise || widening > 0.5 * std)) {
      means = true;
      mode.frequency_hz.value = f.mean;
      mode.damping_ratio.value = z.mean;
      const double omega = kTwoPi * f.mean;
      mode.pole_rad_s =
          Complex(-z.mean * omega, omega * std::sqrt(std::max(0.0, 1 - z.mean * z.mean)));
      const Complex measured = mode.pole_rad_s - frfs.exponential_decay_rate_1_s;
      mode.damping_ratio_with_window = -measured.real() / std::abs(measured);
    }
    const auto widen = [&](Estimate& value, Index row, double least) {
      if (!(value.std < least)) return;
      if (model.pole_covariance.rows() > row && value.std > 0) {
        model.pole_covariance.row(row) *= least / value.std;
        model.pole_covariance.col(row) *= least / value.std;
      }
      value.std = least;
    };
    widen(mode.frequency_hz, static_cast<Index>(2 * r), widened_std(f));
    widen(mode.damping_ratio, static_cast<Index>(2 * r + 1), widened_std(z));
    const double part = mode.between_hits.frequency_std_hz / mode.frequency_hz.value;
    if (part > largest) largest = part, times = std::sqrt(f.variance / f_noise);
  }
  mark_doubles(frequency, allowed, model);
  if (!all_differ) return;
  model.notes.push_back(
      {"hits_disagree",
       fmt::format(
           "frequencies differ from hit to hit by up to {:.2g} % (one standard deviation), "
           "{:.1f} times what noise gives: the structure, the hammer or the place struck "
           "changes; {}error bars are those of the scatter between hits",
           100 * largest, times,
           means ? "values are means over the hits where the average would be biased, " : ""),
       ""});
}

}  // namespace rigfit::signal
