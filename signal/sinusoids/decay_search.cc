#include "signal/sinusoids/decay_modes.h"

#include <gsl/gsl_fit.h>

#include "signal/estimation/robust.h"
#include "signal/spectra/fft.h"

namespace rigfit::signal {
namespace {

// Beyond this many time constants the window holds nothing of the sinusoid.
constexpr double kWindowTimeConstants = 8;

// Median of the power around line k, over as many lines as tell the noise from the peak.
double local_median(const VectorXd& power, Index k, Index reach) {
  const Index lo = std::clamp<Index>(k - reach, 1, power.size() - 1);
  const Index hi = std::clamp<Index>(k + reach, lo, power.size() - 1);
  return median({power.data() + lo, power.data() + hi + 1});
}

// So many peaks are kept: what is distinct among them is enough.
constexpr std::ptrdiff_t kKeep = 64;

/// Adds the peaks of the filter of decay rate a, and keeps the strongest.
void add_peaks(const LineSpectrum& spectrum, double a, const DecaySearchOptions& options,
               std::vector<DecayCandidate>& found) {
  const auto n = static_cast<double>(spectrum.samples);
  const auto& power = spectrum.power;
  const double per_cycle = spectrum.lines_per_cycle;
  // A pole with damping ratio over 0.9 or with under half a cycle in the record is no oscillation.
  const double lowest = std::max({options.lowest, a * 0.075, 0.5 / n});
  const Index first = std::max<Index>(1, static_cast<Index>(std::ceil(lowest * per_cycle)));
  const Index last = std::min<Index>(power.size() - 1,
                                     static_cast<Index>(std::floor(options.highest * per_cycle)));
  for (Index k = first; k <= last; ++k) {
    const double p = power(k);
    if (p < 1e-16 * spectrum.total || (k > first && power(k - 1) > p) ||
        (k < last && power(k + 1) >= p))
      continue;
    double shift = 0, peak = p;
    if (k + 1 < power.size()) {
      const double left = power(k - 1), right = power(k + 1), bend = left - 2 * p + right;
      if (bend < 0) {
        shift = std::clamp(0.5 * (left - right) / bend, -0.5, 0.5);
        peak = p - 0.25 * (left - right) * shift;
      }
    }
    const double frequency = std::clamp((static_cast<double>(k) + shift) / per_cycle, lowest, 0.5);
    found.push_back({Complex(-std::max(a, kFreeDecay / n), kTwoPi * frequency), peak, 0});
  }
  if (std::ssize(found) <= kKeep) return;
  std::ranges::nth_element(found, found.begin() + kKeep, std::greater(), &DecayCandidate::energy);
  found.erase(found.begin() + kKeep, found.end());
}

/// The output of the filter of decay rate a.
LineSpectrum filtered(const Ref<const VectorXd>& y, double a) {
  LineSpectrum out;
  out.samples = y.size();
  if (y.size() < 4) return out;
  const Index length = static_cast<Index>(
      std::clamp(std::ceil(kWindowTimeConstants / a), 4.0, static_cast<double>(y.size())));
  RealFft fft(good_fft_length(2 * length));
  auto time = fft.time();
  time.tail(time.size() - length).setZero();
  const double q = std::exp(-a);
  double w = 1, energy = 0;
  for (Index j = 0; j < length; ++j, w *= q) {
    time(j) = w * y(j);
    energy += w * w;
  }
  fft.forward();
  out.power = fft.spectrum().cwiseAbs2() * (2 / energy);
  out.lines_per_cycle = static_cast<double>(fft.length());
  out.total = y.squaredNorm();
  return out;
}

}  // namespace

double detection_threshold(Index samples, double false_alarm) {
  // chi-squared with two degrees: P(> x) = exp(-x/2); N/2 independent lines times the handful of
  // independent decay rates (a factor of e apart: ln N of them).
  const double n = static_cast<double>(std::max<Index>(samples, 4));
  return 2 * std::log(0.5 * n * std::log(n) / false_alarm);
}

VectorXd without_trend(const Ref<const VectorXd>& y) {
  const Index n = y.size();
  const ArrayXd present = y.array().isFinite().cast<double>();
  if (present.sum() < 2) return VectorXd::Zero(n);
  const ArrayXd values = (present > 0).select(y.array(), 0);
  const ArrayXd t = ArrayXd::LinSpaced(n, -1, 1);
  double level = 0, slope = 0, unused[4];
  gsl_fit_wlinear(t.data(), 1, present.data(), 1, values.data(), 1, static_cast<std::size_t>(n),
                  &level, &slope, &unused[0], &unused[1], &unused[2], &unused[3]);
  return present * (values - level - slope * t);
}

LineSpectrum line_spectrum(const Ref<const VectorXd>& y) { return filtered(y, 0); }

double noise_near(const LineSpectrum& undamped, Complex pole) {
  const auto n = static_cast<double>(undamped.samples);
  // Near enough to follow coloured noise, far enough to look past the line itself.
  const double line = pole.imag() / kTwoPi * n;
  const double lines = std::clamp(0.5 * line, 8.0, 64.0) - 2 * pole.real() * n / std::numbers::pi;
  const double per_line = undamped.lines_per_cycle / n;
  const double middle = local_median(undamped.power, std::lround(line * per_line),
                                     static_cast<Index>(lines * per_line));
  // Median of an exponential distribution of mean 2 s^2 is 2 s^2 ln 2.
  return std::max(middle / (2 * std::numbers::ln2), 1e-30 * undamped.total / n);
}

std::vector<DecayCandidate> search_decays(const Ref<const VectorXd>& y,
                                          const DecaySearchOptions& options) {
  const auto n = static_cast<double>(y.size());
  if (y.size() < 4) return {};
  const LineSpectrum undamped = line_spectrum(y);
  std::vector<DecayCandidate> peaks, distinct;
  add_peaks(undamped, 0, options, peaks);
  for (double decays = 1; decays <= 2 * n; decays *= 2.5) {
    add_peaks(filtered(y, decays / n), decays / n, options, peaks);
  }
  // Strongest first: what is weaker may be no more than the spread skirt of what is stronger.
  std::ranges::sort(peaks, std::greater(), &DecayCandidate::energy);
  for (auto& c : peaks) {
    if (static_cast<int>(distinct.size()) >= options.candidates) break;
    // Distinct: further apart than the lines' own widths, and more than the skirt there, whose
    // energy falls with the square of the distance.
    const bool same = std::ranges::any_of(distinct, [&](const DecayCandidate& d) {
      const double width = kTwoPi / n - 0.5 * (c.pole.real() + d.pole.real());
      const double apart = std::abs(c.pole.imag() - d.pole.imag());
      return apart < 1.5 * width * std::sqrt(d.energy / c.energy);
    });
    if (same) continue;
    c.noise_variance = noise_near(undamped, c.pole);
    if (c.energy >= options.energy_over_noise * c.noise_variance) distinct.push_back(c);
  }
  return distinct;
}

}  // namespace rigfit::signal
