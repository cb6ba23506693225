#include "signal/decay_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "signal/damped_sinusoids.h"
#include "signal/fft.h"
#include "signal/numbers.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
// Beyond this many time constants the window holds nothing of the sinusoid.
constexpr double kWindowTimeConstants = 8;
// Above this length the spectrum is not interpolated by zeros: half a line costs at most 60 % of
// the peak and the fit that follows finds the rest.
constexpr Index kNoPaddingFrom = 1 << 16;

// Median of the power around line k, over as many lines as tell the noise from the peak.
double local_median(const Eigen::VectorXd& power, Index k, Index reach, std::vector<double>& work) {
  const Index lo = std::max<Index>(1, k - reach), hi = std::min(power.size() - 1, k + reach);
  work.assign(power.data() + lo, power.data() + hi + 1);
  const auto middle = work.begin() + static_cast<std::ptrdiff_t>(work.size() / 2);
  std::nth_element(work.begin(), middle, work.end());
  return *middle;
}

}  // namespace

double detection_threshold(Index samples, double false_alarm) {
  // chi-squared with two degrees: P(> x) = exp(-x/2); N/2 independent lines times the handful of
  // independent decay rates (a factor of e apart: ln N of them).
  const double n = static_cast<double>(std::max<Index>(samples, 4));
  return 2 * std::log(0.5 * n * std::log(n) / false_alarm);
}

Eigen::VectorXd without_trend(const Eigen::Ref<const Eigen::VectorXd>& y) {
  const Index n = y.size();
  double count = 0, st = 0, stt = 0, sy = 0, sty = 0;
  const double middle = 0.5 * static_cast<double>(n - 1);
  for (Index j = 0; j < n; ++j) {
    if (!std::isfinite(y(j))) continue;
    const double t = static_cast<double>(j) - middle;
    count += 1, st += t, stt += t * t, sy += y(j), sty += t * y(j);
  }
  const double determinant = count * stt - st * st;
  double slope = 0, level = count > 0 ? sy / count : 0;
  if (determinant > 0) {
    slope = (count * sty - st * sy) / determinant;
    level = (sy - slope * st) / count;
  }
  Eigen::VectorXd out(n);
  for (Index j = 0; j < n; ++j) {
    out(j) = std::isfinite(y(j)) ? y(j) - level - slope * (static_cast<double>(j) - middle) : 0;
  }
  return out;
}

std::vector<DecayCandidate> search_decays(const Eigen::Ref<const Eigen::VectorXd>& y,
                                          const DecaySearchOptions& options) {
  const Index n = y.size();
  std::vector<DecayCandidate> found;
  if (n < 4) return found;
  Eigen::VectorXd undamped;  // 2 |F|^2 / N
  double undamped_lines_per_cycle = 0;
  Eigen::VectorXd power;
  std::vector<double> work;
  double decays = 0;  // a N
  const double total = y.squaredNorm();
  while (true) {
    const double a = decays / static_cast<double>(n);
    if (a > 2) break;
    const Index length =
        a > 0 ? std::clamp<Index>(static_cast<Index>(std::ceil(kWindowTimeConstants / a)), 4, n)
              : n;
    RealFft fft(good_fft_length(length < kNoPaddingFrom ? 2 * length : length));
    auto time = fft.time();
    time.tail(time.size() - length).setZero();
    double window_energy = 0;
    if (a == 0) {
      time.head(length) = y;
      window_energy = static_cast<double>(length);
    } else {
      const double q = std::exp(-a);
      double w = 1;
      for (Index j = 0; j < length; ++j) {
        time(j) = w * y(j);
        window_energy += w * w;
        w *= q;
      }
    }
    fft.forward();
    power = fft.spectrum().cwiseAbs2() * (2 / window_energy);
    const double lines_per_cycle = static_cast<double>(fft.length());
    if (a == 0) {
      undamped = power;
      undamped_lines_per_cycle = lines_per_cycle;
    }
    // A pole with damping ratio over 0.9 or with under half a cycle in the record is no
    // oscillation.
    const double lowest = std::max({options.lowest, a * 0.075, 0.5 / static_cast<double>(n)});
    const Index first = std::max<Index>(1, static_cast<Index>(std::ceil(lowest * lines_per_cycle)));
    const Index last = std::min<Index>(
        power.size() - 1, static_cast<Index>(std::floor(options.highest * lines_per_cycle)));
    // Only cells that explain something are worth the median of the noise around them.
    for (Index k = first; k <= last; ++k) {
      const double p = power(k);
      if ((k > first && power(k - 1) > p) || (k < last && power(k + 1) >= p)) continue;
      if (p < 1e-16 * total) continue;
      double shift = 0, peak = p;
      if (k > 0 && k + 1 < power.size()) {
        const double left = power(k - 1), right = power(k + 1), bend = left - 2 * p + right;
        if (bend < 0) {
          shift = std::clamp(0.5 * (left - right) / bend, -0.5, 0.5);
          peak = p - 0.25 * (left - right) * shift;
        }
      }
      const double frequency =
          std::clamp((static_cast<double>(k) + shift) / lines_per_cycle, lowest, 0.5);
      found.push_back({Complex(-a, kTwoPi * frequency), peak, 0});
    }
    // Keep the strongest only, so that long records do not collect a peak for every other line.
    const std::size_t keep = 64;
    if (found.size() > keep) {
      std::nth_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(keep),
                       found.end(),
                       [](const auto& l, const auto& r) { return l.energy > r.energy; });
      found.resize(keep);
    }
    if (!options.damped) break;
    decays = decays == 0 ? 1 : decays * 2.5;
  }
  for (auto& c : found) {
    const auto k =
        static_cast<Index>(std::lround(c.pole.imag() / kTwoPi * undamped_lines_per_cycle));
    // Near enough to follow coloured noise, far enough to look past the line itself.
    const double line = c.pole.imag() / kTwoPi * static_cast<double>(n);
    const double lines = std::clamp(0.5 * line, 8.0, 64.0) -
                         2 * c.pole.real() * static_cast<double>(n) / std::numbers::pi;
    const auto reach =
        static_cast<Index>(lines * undamped_lines_per_cycle / static_cast<double>(n));
    // Median of an exponential distribution of mean 2 s^2 is 2 s^2 ln 2.
    c.noise_variance = std::max(local_median(undamped, k, reach, work) / (2 * std::numbers::ln2),
                                1e-30 * total / static_cast<double>(n));
  }
  // Strongest first: what is weaker may be no more than the spread skirt of what is stronger.
  std::erase_if(found, [&](const DecayCandidate& c) {
    return c.energy < options.energy_over_noise * c.noise_variance;
  });
  std::sort(found.begin(), found.end(),
            [](const auto& l, const auto& r) { return l.energy > r.energy; });
  // Distinct: further apart than the lines' own widths.
  std::vector<DecayCandidate> distinct;
  for (const auto& c : found) {
    if (static_cast<int>(distinct.size()) >= options.candidates) break;
    const bool same = std::any_of(distinct.begin(), distinct.end(), [&](const DecayCandidate& d) {
      const double width = kTwoPi / static_cast<double>(n) - 0.5 * (c.pole.real() + d.pole.real());
      return std::abs(c.pole.imag() - d.pole.imag()) < 1.5 * width;
    });
    if (!same) distinct.push_back(c);
  }
  return distinct;
}

std::vector<DecayCandidate> few_cycle_starts(const Eigen::Ref<const Eigen::VectorXd>& y,
                                             const DecayCandidate& candidate,
                                             const DecaySearchOptions& options) {
  // Where this many cycles fit into the record and into the decay, the bank is right.
  constexpr double kManyCycles = 6;
  const double w = candidate.pole.imag(), a = -candidate.pole.real();
  const double cycles_in_record = w / kTwoPi * static_cast<double>(y.size());
  const double cycles_alive = a > 0 ? w / kTwoPi / a * 3 : cycles_in_record;
  std::vector<DecayCandidate> starts;
  if (std::min(cycles_in_record, cycles_alive) > kManyCycles && y.size() > 64) return starts;

  const Index length =
      a > 0 ? std::min<Index>(
                  y.size(),
                  std::max<Index>(16, static_cast<Index>(std::ceil(kWindowTimeConstants / a))))
            : y.size();
  // Averages over blocks: at least 16 a cycle of what is looked for, at most all samples.
  const double top =
      std::min({0.5 * static_cast<double>(length), options.highest * static_cast<double>(length),
                std::max(kManyCycles, 2 * w / kTwoPi * static_cast<double>(length))});
  const Index wanted = std::clamp<Index>(static_cast<Index>(16 * top), 64, 192);
  const Index block = std::max<Index>(1, length / wanted);
  const Index count = length / block;
  if (count < 8) return starts;
  Eigen::VectorXd coarse(count);
  for (Index j = 0; j < count; ++j) coarse(j) = y.segment(j * block, block).mean();
  DampedSinusoidsOptions evaluate_only;
  evaluate_only.max_iterations = 0;
  const double n = static_cast<double>(count);
  const double lowest = std::max(0.4, options.lowest * static_cast<double>(length));
  for (double decays : {0.0, 1.5, 4.0, 8.0, 16.0}) {
    for (double cycles = lowest; cycles <= std::min(top, 0.5 * n); cycles *= 1.12) {
      if (decays > 12 * cycles) continue;
      const Complex pole(-decays / n, kTwoPi * cycles / n);
      const auto fit = fit_damped_sinusoids(coarse, std::span(&pole, 1), evaluate_only);
      if (fit.unit_covariance.size() == 0) continue;
      starts.push_back(
          {pole / static_cast<double>(block), -fit.residual_sum_squares, candidate.noise_variance});
    }
  }
  std::sort(starts.begin(), starts.end(),
            [](const auto& l, const auto& r) { return l.energy > r.energy; });
  if (starts.size() > 4) starts.resize(4);
  return starts;
}

}  // namespace rigfit::signal
