#include "signal/sinusoids/decay_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "signal/numerics/numbers.h"
#include "signal/sinusoids/damped_sinusoids.h"
#include "signal/spectra/fft.h"

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

namespace {

// The strongest peaks of spectra, so many of them that what is distinct among them is enough.
class PeakCollector {
 public:
  PeakCollector(const DecaySearchOptions& options, Index samples, double total)
      : options_(options), n_(static_cast<double>(samples)), total_(total) {}

  /// Peaks of the filter of decay rate a.
  void add(const Eigen::VectorXd& power, double lines_per_cycle, double a) {
    // A pole with damping ratio over 0.9 or with under half a cycle in the record is no
    // oscillation.
    const double lowest = std::max({options_.lowest, a * 0.075, 0.5 / n_});
    const Index first = std::max<Index>(1, static_cast<Index>(std::ceil(lowest * lines_per_cycle)));
    const Index last = std::min<Index>(
        power.size() - 1, static_cast<Index>(std::floor(options_.highest * lines_per_cycle)));
    for (Index k = first; k <= last; ++k) {
      const double p = power(k);
      if (p < least_) continue;
      if ((k > first && power(k - 1) > p) || (k < last && power(k + 1) >= p)) continue;
      if (p < 1e-16 * total_) continue;
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
      found.push_back({Complex(-std::max(a, kFreeDecay / n_), kTwoPi * frequency), peak, 0});
      if (found.size() >= 4 * kKeep) keep_strongest();
    }
    keep_strongest();
  }

  std::vector<DecayCandidate> found;

 private:
  static constexpr std::size_t kKeep = 64;

  // Long records would collect a peak for every third line. What is left out from here on is too
  // weak for its parabola, which adds an eighth at most, to lift it among those that are kept.
  void keep_strongest() {
    if (found.size() <= kKeep) return;
    const auto middle = found.begin() + static_cast<std::ptrdiff_t>(kKeep);
    std::nth_element(found.begin(), middle, found.end(),
                     [](const auto& l, const auto& r) { return l.energy > r.energy; });
    found.resize(kKeep);
    double weakest = found.front().energy;
    for (const auto& c : found) weakest = std::min(weakest, c.energy);
    least_ = std::max(least_, weakest / 1.125);
  }

  const DecaySearchOptions& options_;
  double n_, total_, least_ = 0;
};

// White-equivalent noise beside each peak.
void read_noise(std::vector<DecayCandidate>& peaks, const LineSpectrum& undamped) {
  const auto n = static_cast<double>(undamped.samples);
  std::vector<double> work;
  for (auto& c : peaks) {
    const auto k =
        static_cast<Index>(std::lround(c.pole.imag() / kTwoPi * undamped.lines_per_cycle));
    // Near enough to follow coloured noise, far enough to look past the line itself.
    const double line = c.pole.imag() / kTwoPi * n;
    const double lines =
        std::clamp(0.5 * line, 8.0, 64.0) - 2 * c.pole.real() * n / std::numbers::pi;
    const auto reach = static_cast<Index>(lines * undamped.lines_per_cycle / n);
    // Median of an exponential distribution of mean 2 s^2 is 2 s^2 ln 2.
    c.noise_variance =
        std::max(local_median(undamped.power, k, reach, work) / (2 * std::numbers::ln2),
                 1e-30 * undamped.total / n);
  }
}

Index spectrum_length(Index samples) {
  return good_fft_length(samples < kNoPaddingFrom ? 2 * samples : samples);
}

// The filter of decay rate a, by the first `length` samples.
void filter(const Eigen::Ref<const Eigen::VectorXd>& y, Index length, double a, RealFft& fft,
            Eigen::VectorXd& power) {
  auto time = fft.time();
  double window_energy = 0;
  const double q = std::exp(-a);
  double w = 1;
  for (Index j = 0; j < length; ++j, w *= q) {
    time(j) = w * y(j);
    window_energy += w * w;
  }
  time.tail(time.size() - length).setZero();
  fft.forward();
  power = fft.spectrum().cwiseAbs2() * (2 / window_energy);
}

}  // namespace

LineSpectrum line_spectrum(const Eigen::Ref<const Eigen::VectorXd>& y) {
  LineSpectrum out;
  out.samples = y.size();
  if (y.size() < 4) return out;
  RealFft fft(spectrum_length(y.size()));
  filter(y, y.size(), 0, fft, out.power);
  out.lines_per_cycle = static_cast<double>(fft.length());
  out.total = y.squaredNorm();
  return out;
}

std::vector<DecayCandidate> search_lines(const LineSpectrum& spectrum,
                                         const DecaySearchOptions& options) {
  if (spectrum.samples < 4) return {};
  PeakCollector peaks(options, spectrum.samples, spectrum.total);
  peaks.add(spectrum.power, spectrum.lines_per_cycle, 0);
  read_noise(peaks.found, spectrum);
  return distinct_decays(std::move(peaks.found), spectrum.samples, options);
}

std::vector<DecayCandidate> decay_peaks(const Eigen::Ref<const Eigen::VectorXd>& y,
                                        const DecaySearchOptions& options) {
  const Index n = y.size();
  if (n < 4) return {};
  LineSpectrum undamped;
  undamped.samples = n;
  undamped.total = y.squaredNorm();
  PeakCollector peaks(options, n, undamped.total);
  std::optional<RealFft> fft;  // serves the rates whose window is the whole record
  Eigen::VectorXd power;
  for (double decays = 0; decays <= 2 * static_cast<double>(n);
       decays = decays == 0 ? 1 : decays * 2.5) {
    const double a = decays / static_cast<double>(n);
    const Index length =
        a > 0 ? std::clamp<Index>(static_cast<Index>(std::ceil(kWindowTimeConstants / a)), 4, n)
              : n;
    const Index wanted = spectrum_length(length);
    if (!fft || fft->length() != wanted) fft.emplace(wanted);
    filter(y, length, a, *fft, a == 0 ? undamped.power : power);
    if (a == 0) undamped.lines_per_cycle = static_cast<double>(wanted);
    peaks.add(a == 0 ? undamped.power : power, static_cast<double>(wanted), a);
  }
  fft.reset();
  read_noise(peaks.found, undamped);
  return std::move(peaks.found);
}

std::vector<DecayCandidate> distinct_decays(std::vector<DecayCandidate> peaks, Index samples,
                                            const DecaySearchOptions& options) {
  // Strongest first: what is weaker may be no more than the spread skirt of what is stronger.
  std::erase_if(peaks, [&](const DecayCandidate& c) {
    return c.energy < options.energy_over_noise * c.noise_variance;
  });
  std::sort(peaks.begin(), peaks.end(),
            [](const auto& l, const auto& r) { return l.energy > r.energy; });
  // Distinct: further apart than the lines' own widths.
  std::vector<DecayCandidate> distinct;
  for (const auto& c : peaks) {
    if (static_cast<int>(distinct.size()) >= options.candidates) break;
    const bool same = std::any_of(distinct.begin(), distinct.end(), [&](const DecayCandidate& d) {
      const double width =
          kTwoPi / static_cast<double>(samples) - 0.5 * (c.pole.real() + d.pole.real());
      return std::abs(c.pole.imag() - d.pole.imag()) < 1.5 * width;
    });
    if (!same) distinct.push_back(c);
  }
  return distinct;
}

}  // namespace rigfit::signal
