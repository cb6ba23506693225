#include "signal/envelope/envelope.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "signal/numerics/numbers.h"
#include "signal/spectra/fft.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Above this length the band's signal is evaluated only as often as the band needs it.
constexpr Index kEverySampleTo = 1 << 16;

struct BandSignal {
  Eigen::VectorXcd values;  // at 0, step, 2 step ... samples
  double step = 1;
};

// Analytic signal of `residual` in the band (cycles per sample), raised-cosine edges.
BandSignal band_analytic(const Eigen::VectorXd& residual, double centre, double half_width) {
  const Index n = residual.size();
  const Complex minus_i(0, -1);
  const Index length = good_fft_length(n + n / 4 + 16);
  const auto per_cycle = static_cast<double>(length);
  const auto first =
      std::max<Index>(0, static_cast<Index>(std::ceil((centre - half_width) * per_cycle)));
  Eigen::VectorXcd band;  // lines from `first` on
  const auto take = [&](RealFft& fft) {
    fft.time().head(n) = residual;
    fft.time().tail(length - n).setZero();
    fft.forward();
    const auto last = std::min(fft.lines() - 1,
                               static_cast<Index>(std::floor((centre + half_width) * per_cycle)));
    band = fft.spectrum().segment(first, std::max<Index>(0, last - first + 1));
    for (Index k = 0; k < band.size(); ++k) {
      const double x = std::abs(static_cast<double>(first + k) / per_cycle - centre) / half_width;
      band(k) *= x < 0.75 ? 1
                 : x < 1  ? 0.5 * (1 + std::cos(std::numbers::pi * (x - 0.75) / 0.25))
                          : 0;
    }
  };
  // Line first + k of the long transform is line at + k of the one that goes back: the same one, or
  // a short one about frequency zero, turned up again afterwards.
  const auto back = [&](RealFft& fft, Index at) {
    Eigen::VectorXcd values(std::min(
        fft.length(),
        static_cast<Index>(
            std::ceil(static_cast<double>(n) * static_cast<double>(fft.length()) / per_cycle))));
    const auto part = [&](Complex factor) {
      fft.spectrum().setZero();
      fft.spectrum().segment(at, band.size()) = factor * band;
      fft.inverse();
      return fft.time().head(values.size()) * (static_cast<double>(fft.length()) / per_cycle);
    };
    values.real() = part(1);
    values.imag() = part(minus_i);  // the Hilbert transform of the band
    return values;
  };
  BandSignal out;
  if (n <= kEverySampleTo) {
    RealFft fft(length);
    take(fft);
    out.values = back(fft, first);
    return out;
  }
  {
    RealFft fft(length);
    take(fft);
  }
  // Twice the samples that a complex signal of that bandwidth needs; line 0 has no partner.
  const Index fewer = good_fft_length(4 * (band.size() + 1));
  RealFft fft(std::min(fewer, length));
  const Index at = fewer < length ? 1 : first;
  out.values = back(fft, at);
  out.step = per_cycle / static_cast<double>(fft.length());
  const double turn = kTwoPi * static_cast<double>(first - at) / static_cast<double>(fft.length());
  for (Index j = 0; j < out.values.size(); ++j) {
    out.values(j) *= std::polar(1.0, turn * static_cast<double>(j));
  }
  return out;
}

struct WeightedLine {
  double level = 0, slope = 0, slope_variance = 0, chi2 = 0;
};

WeightedLine weighted_line(const std::vector<double>& x, const std::vector<double>& y,
                           const std::vector<double>& std) {
  double s = 0, sx = 0, sy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double w = 1 / (std[i] * std[i]);
    s += w, sx += w * x[i], sy += w * y[i];
  }
  double sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double w = 1 / (std[i] * std[i]);
    sxx += w * (x[i] - sx / s) * (x[i] - sx / s), sxy += w * (x[i] - sx / s) * (y[i] - sy / s);
  }
  WeightedLine line;
  if (!(sxx > 0)) return line;
  line.slope = sxy / sxx;
  line.level = sy / s - line.slope * sx / s;
  line.slope_variance = 1 / sxx;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double r = (y[i] - line.level - line.slope * x[i]) / std[i];
    line.chi2 += r * r;
  }
  return line;
}

}  // namespace

const char* name_of(DecayLaw law) {
  switch (law) {
    case DecayLaw::exponential:
      return "exponential";
    case DecayLaw::friction:
      return "friction";
    case DecayLaw::drag:
      return "drag";
  }
  return "exponential";
}

EnvelopeResult mode_envelope(const DampedSinusoidsFit& fit, std::size_t m, double sample_rate_hz,
                             double noise_variance, const EnvelopeOptions& options) {
  EnvelopeResult result;
  const Index n = fit.samples;
  const Complex pole = fit.poles[m];
  const double frequency = pole.imag() / kTwoPi;
  double half_width = std::min(0.4 * frequency, 0.5 - frequency);
  for (std::size_t k = 0; k < fit.poles.size(); ++k) {
    if (k != m) {
      half_width = std::min(half_width, 0.5 * std::abs(fit.poles[k].imag() - pole.imag()) / kTwoPi);
    }
  }
  half_width = std::max(half_width, 2.0 / static_cast<double>(n));
  const BandSignal band = band_analytic(fit.residual, frequency, half_width);
  const Eigen::VectorXcd& extra = band.values;
  const Index points = extra.size();
  // E|analytic noise|^2 in a band of width W cycles per sample is 4 s^2 W.
  const double width = 2 * half_width * 0.875;
  const double noise_power = std::max(4 * noise_variance * width, 1e-300);

  // Rotated back by the fitted pole's frequency: slow amplitude and phase.
  Eigen::VectorXd log_amplitude(points), phase(points);
  double previous = 0, turns = 0;
  Index clear = points;
  const double least = options.least_amplitude * options.least_amplitude * noise_power;
  // Loss of signal is judged over a cycle, so that one noisy sample does not end the decay.
  const auto cycle = static_cast<Index>(std::max(1.0, std::ceil(1 / (frequency * band.step))));
  Index below = 0;
  for (Index j = 0; j < points; ++j) {
    const double t = static_cast<double>(j) * band.step;
    const Complex u = fit.amplitudes[m] * std::exp(pole.real() * t) +
                      extra(j) * std::polar(1.0, -pole.imag() * t);
    const double power = std::norm(u);
    below = power < least ? below + 1 : 0;
    if (below >= cycle) {
      clear = j + 1 - below;
      break;
    }
    log_amplitude(j) = 0.5 * std::log(std::max(power, 1e-300));
    double angle = std::arg(u);
    if (j > 0) {
      const double jump = angle + turns - previous;
      turns -= kTwoPi * std::round(jump / kTwoPi);
      angle += turns;
    }
    previous = phase(j) = angle;
  }
  result.clear_until_s = static_cast<double>(clear) * band.step / sample_rate_hz;
  const double cycles = static_cast<double>(clear) * band.step * frequency;
  const int spans = std::min(options.points, static_cast<int>(cycles / options.least_cycles));
  std::vector<double> times, rates, rate_stds, logs, inverse, amplitudes, frequencies,
      frequency_stds;
  for (int s = 0; s < spans; ++s) {
    const Index from = clear * s / spans, length = clear * (s + 1) / spans - from;
    if (length < 8) break;
    double st = 0, sa = 0, sp = 0;
    for (Index j = from; j < from + length; ++j) {
      st += static_cast<double>(j) * band.step, sa += log_amplitude(j), sp += phase(j);
    }
    const double count = static_cast<double>(length);
    const double mt = st / count, ma = sa / count, mp = sp / count;
    double stt = 0, sta = 0, stp = 0;
    for (Index j = from; j < from + length; ++j) {
      const double dt = static_cast<double>(j) * band.step - mt;
      stt += dt * dt, sta += dt * (log_amplitude(j) - ma), stp += dt * (phase(j) - mp);
    }
    const double rate = -sta / stt * sample_rate_hz;
    const double f = (pole.imag() + stp / stt) / kTwoPi * sample_rate_hz;
    // ln|u| and arg u each carry half the band's noise power over |u|^2; a band of width W gives W
    // independent values a sample.
    const double amplitude = std::exp(ma);
    const double slope_std = std::sqrt(0.5 * noise_power / (amplitude * amplitude) /
                                       (std::min(1.0, width * band.step) * stt)) *
                             sample_rate_hz;
    const double w = kTwoPi * f;
    const double modulus = std::sqrt(rate * rate + w * w);
    EnvelopePoint point;
    point.time_s = mt / sample_rate_hz;
    point.amplitude = amplitude;
    point.frequency_hz = {f, slope_std / kTwoPi};
    point.damping_ratio = {rate / modulus, slope_std / modulus};
    result.points.push_back(point);
    times.push_back(point.time_s);
    rates.push_back(rate);
    rate_stds.push_back(slope_std);
    logs.push_back(ma);
    amplitudes.push_back(amplitude);
    inverse.push_back(1 / amplitude);
    frequencies.push_back(f);
    frequency_stds.push_back(slope_std / kTwoPi);
  }
  const std::size_t k = result.points.size();
  if (k < 2) return result;
  const WeightedLine drift = weighted_line(times, frequencies, frequency_stds);
  const double span = times.back() - times.front();
  // Misfit of the line beyond the noise counts as uncertainty.
  const double excess = k > 2 ? std::max(1.0, drift.chi2 / static_cast<double>(k - 2)) : 1.0;
  result.frequency_drift_hz = {drift.slope * span, std::sqrt(drift.slope_variance * excess) * span};
  if (k < 3) return result;
  std::vector<double> zetas, zeta_stds;
  for (const auto& p : result.points) {
    zetas.push_back(p.damping_ratio.value), zeta_stds.push_back(p.damping_ratio.std);
  }
  const WeightedLine trend = weighted_line(logs, zetas, zeta_stds);
  const double trend_excess = std::max(1.0, trend.chi2 / static_cast<double>(k - 2));
  result.damping_per_log_amplitude = {trend.slope, std::sqrt(trend.slope_variance * trend_excess)};
  // As in the modes: no free oscillation takes energy in.
  for (auto& p : result.points) p.damping_ratio.value = std::max(0.0, p.damping_ratio.value);
  // Exponential: one constant. Friction and drag: one coefficient more, which must not be negative.
  double weight = 0, mean = 0, constant_chi2 = 0;
  for (std::size_t i = 0; i < k; ++i) {
    const double w = 1 / (rate_stds[i] * rate_stds[i]);
    weight += w, mean += w * rates[i];
  }
  mean /= weight;
  for (std::size_t i = 0; i < k; ++i) {
    constant_chi2 += (rates[i] - mean) * (rates[i] - mean) / (rate_stds[i] * rate_stds[i]);
  }
  const WeightedLine friction = weighted_line(inverse, rates, rate_stds);
  const WeightedLine drag = weighted_line(amplitudes, rates, rate_stds);
  const double friction_gain = friction.slope > 0 ? constant_chi2 - friction.chi2 : 0;
  const double drag_gain = drag.slope > 0 ? constant_chi2 - drag.chi2 : 0;
  // A coefficient must pay five standard uncertainties to be believed.
  const double gain = std::max(friction_gain, drag_gain);
  if (gain > 25) {
    result.law = friction_gain >= drag_gain ? DecayLaw::friction : DecayLaw::drag;
    result.law_evidence = gain;
  }
  return result;
}

}  // namespace rigfit::signal
