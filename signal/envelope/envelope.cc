#include "signal/envelope/envelope.h"

#include <gsl/gsl_fit.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "signal/numerics/factorisations.h"
#include "signal/numerics/numbers.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Fewer samples than this leave too little beside three coefficients.
constexpr double kFewestForEnvelope = 8;
// The decay ends where a cycle's amplitude is below so many standard deviations of its noise: the
// bias of ln|C|, half the relative variance, is then 3 %.
constexpr double kLeastAmplitude = 4;
constexpr std::size_t kPoints = 8, kLeastCycles = 2;
// Drop in chi-squared that a law of one coefficient more must bring: five standard uncertainties.
constexpr double kLawGain = 25;

struct FittedLine {
  double level = 0, slope = 0, slope_variance = 0, chi2 = 0;
  [[nodiscard]] double at(double x) const { return level + slope * x; }
};

FittedLine weighted_line(const double* x, const double* weight, const double* y, std::size_t n) {
  FittedLine line;
  double level_variance = 0, covariance = 0;
  gsl_fit_wlinear(x, 1, weight, 1, y, 1, n, &line.level, &line.slope, &level_variance, &covariance,
                  &line.slope_variance, &line.chi2);
  return line;
}

/// Variance of the slope where the line's misfit beyond the noise counts as uncertainty.
double widened_variance(const FittedLine& line, std::size_t n) {
  return line.slope_variance * (n > 2 ? std::max(1.0, line.chi2 / static_cast<double>(n - 2)) : 1);
}

/// By the curve of ln|C| over time: under friction damping rises as the motion dies.
DecayLaw law_of(const CycleAmplitudes& cycles) {
  const auto n = static_cast<Index>(cycles.time_s.size());
  const Eigen::Map<const Eigen::ArrayXd> time(cycles.time_s.data(), n),
      weight(cycles.weight.data(), n), log_size(cycles.log_size.data(), n);
  const Eigen::ArrayXd std = weight.sqrt(), t = time / time(n - 1);
  Eigen::MatrixXd X(n, 3);
  X << std, std * t, std * t.square();
  const auto qr = thin_qr(X);
  const double curve = qr.Q.col(2).dot((std * log_size).matrix()) * (qr.R(2, 2) > 0 ? 1 : -1);
  if (!(curve * curve > kLawGain)) return DecayLaw::exponential;
  return curve < 0 ? DecayLaw::friction : DecayLaw::drag;
}

}  // namespace

const char* name_of(DecayLaw law) {
  constexpr const char* kNames[] = {"exponential", "friction", "drag"};
  return kNames[static_cast<std::size_t>(law)];
}

CycleAmplitudes cycle_amplitudes(const Eigen::Ref<const Eigen::VectorXd>& alone,
                                 double sample_rate_hz, Complex pole, double noise_variance) {
  CycleAmplitudes cycles;
  cycles.pole = pole, cycles.sample_rate_hz = sample_rate_hz;
  // A cycle; near half the sample rate, where the conjugate pole comes close, a cycle of the beat.
  const double f = pole.imag() / kTwoPi;
  const double length = std::max({kFewestForEnvelope, 1 / f, 1 / std::max(1 - 2 * f, 1e-6)});
  // An amplitude over L samples of noise s^2: E|dC|^2 = 4 s^2 / L.
  const double noise = 4 * std::max(noise_variance, 1e-300) / length;
  const auto count = static_cast<Index>(static_cast<double>(alone.size()) / length);
  for (Index k = 0; k < count; ++k) {
    const auto from = static_cast<Index>(std::lround(static_cast<double>(k) * length));
    const auto to = std::min<Index>(
        alone.size(), static_cast<Index>(std::lround(static_cast<double>(k + 1) * length)));
    const double middle = 0.5 * static_cast<double>(from + to - 1);
    Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    const Complex turn = std::exp(pole);
    Complex z = std::exp(pole * (static_cast<double>(from) - middle));
    for (Index j = from; j < to; ++j, z *= turn) {
      const Eigen::Vector3d row(z.real(), -z.imag(), 1);
      gram += row * row.transpose(), right += alone(j) * row;
    }
    const Eigen::Vector3d fitted = gram.ldlt().solve(right);
    const Complex c(fitted(0), fitted(1));
    if (!(std::norm(c) > kLeastAmplitude * kLeastAmplitude * noise)) break;
    const double angle = std::arg(c * std::polar(1.0, -pole.imag() * middle));
    const double before = cycles.turn.empty() ? angle : cycles.turn.back();
    cycles.time_s.push_back(middle / sample_rate_hz);
    cycles.log_size.push_back(0.5 * std::log(std::norm(c)));
    cycles.turn.push_back(before + std::remainder(angle - before, kTwoPi));
    cycles.weight.push_back(2 * std::norm(c) / noise);
  }
  return cycles;
}

LogDecrement log_decrement(const CycleAmplitudes& cycles) {
  LogDecrement result;
  const std::size_t n = cycles.time_s.size();
  if (n < 3) {
    result.refusal = "fewer than three cycles above the noise";
    return result;
  }
  const FittedLine line =
      weighted_line(cycles.time_s.data(), cycles.weight.data(), cycles.log_size.data(), n);
  const double period = kTwoPi / (cycles.pole.imag() * cycles.sample_rate_hz);
  const double delta = -line.slope * period;
  if (!(delta >= 0)) {
    result.refusal = "the amplitude does not fall";
    return result;
  }
  const double delta_std =
      period * std::sqrt(line.slope_variance * line.chi2 / static_cast<double>(n - 2));
  const double root = std::hypot(kTwoPi, delta);
  result.damping_ratio = {delta / root, delta_std * kTwoPi * kTwoPi / (root * root * root)};
  return result;
}

EnvelopeResult envelope_of(const CycleAmplitudes& cycles) {
  EnvelopeResult result;
  const std::size_t count = cycles.time_s.size(), spans = std::min(kPoints, count / kLeastCycles);
  const double omega = cycles.pole.imag() * cycles.sample_rate_hz;
  std::vector<double> times, frequencies, frequency_weights;
  for (std::size_t s = 0; s < spans; ++s) {
    const std::size_t from = count * s / spans, n = count * (s + 1) / spans - from;
    const double* time = cycles.time_s.data() + from;
    const double* weight = cycles.weight.data() + from;
    const FittedLine size = weighted_line(time, weight, cycles.log_size.data() + from, n);
    const FittedLine turn = weighted_line(time, weight, cycles.turn.data() + from, n);
    const double middle = 0.5 * (time[0] + time[n - 1]), std = std::sqrt(size.slope_variance);
    const double rate = -size.slope, w = omega + turn.slope, modulus = std::hypot(rate, w);
    EnvelopePoint point;
    point.time_s = middle;
    point.amplitude = std::exp(size.at(middle));
    point.frequency_hz = {w / kTwoPi, std / kTwoPi};
    point.damping_ratio = {rate / modulus, std / modulus};
    result.points.push_back(point);
    times.push_back(middle);
    frequencies.push_back(w / kTwoPi), frequency_weights.push_back(kTwoPi * kTwoPi / (std * std));
  }
  if (spans < 2) return result;
  const FittedLine drift =
      weighted_line(times.data(), frequency_weights.data(), frequencies.data(), spans);
  const double lasted = times.back() - times.front();
  result.frequency_drift_hz = {drift.slope * lasted,
                               std::sqrt(widened_variance(drift, spans)) * lasted};
  result.law = law_of(cycles);
  // As in the modes: no free oscillation takes energy in.
  for (auto& p : result.points) p.damping_ratio.value = std::max(0.0, p.damping_ratio.value);
  return result;
}

}  // namespace rigfit::signal
