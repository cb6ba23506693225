#include "signal/envelope/envelope.h"

#include <Eigen/Cholesky>

#include "signal/numerics/factorisations.h"

namespace rigfit::signal {
namespace {

// Fewer samples than this leave too little beside three coefficients.
constexpr double kFewestForEnvelope = 8;
// The decay ends where a cycle's amplitude is below so many standard deviations of its noise: the
// bias of ln|C|, half the relative variance, is then 3 %.
constexpr double kLeastAmplitude = 4;
constexpr std::size_t kPoints = 8, kLeastCycles = 2;
// Drop in chi-squared that a law of one coefficient more must bring: five standard uncertainties.
constexpr double kLawGain = 25;

/// Coefficients of a weighted polynomial, and their standard uncertainties.
struct Polynomial {
  VectorXd coefficients, std;
  double widening = 1;  // the std by the misfit: from below 1 up, or NaN where there is no freedom
};

Polynomial polynomial(const double* x, const double* weight, const double* y, std::size_t count,
                      Index terms) {
  const auto n = static_cast<Index>(count);
  const Map<const ArrayXd> t(x, n), w(weight, n), values(y, n);
  MatrixXd X(n, terms);
  for (Index k = 0; k < terms; ++k) X.col(k) = w.sqrt() * t.pow(static_cast<double>(k));
  const auto qr = thin_qr(X);
  const auto R = qr.R.triangularView<Eigen::Upper>();
  const VectorXd z = w.sqrt() * values, along = qr.Q.transpose() * z;
  const MatrixXd inverse = R.solve(MatrixXd::Identity(terms, terms));
  return {inverse * along, inverse.rowwise().norm(),
          (z - qr.Q * along).norm() / std::sqrt(static_cast<double>(n - terms))};
}

}  // namespace

const char* name_of(DecayLaw law) {
  constexpr const char* kNames[] = {"exponential", "friction", "drag"};
  return kNames[static_cast<std::size_t>(law)];
}

CycleAmplitudes cycle_amplitudes(const Ref<const VectorXd>& alone, double sample_rate_hz,
                                 Complex pole, double noise_variance) {
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
  const auto line =
      polynomial(cycles.time_s.data(), cycles.weight.data(), cycles.log_size.data(), n, 2);
  const double period = kTwoPi / (cycles.pole.imag() * cycles.sample_rate_hz);
  const double delta = -line.coefficients(1) * period;
  if (!(delta >= 0)) {
    result.refusal = "the amplitude does not fall";
    return result;
  }
  const double delta_std = period * line.std(1) * line.widening;
  const double root = std::hypot(kTwoPi, delta);
  result.damping_ratio = {delta / root, delta_std * kTwoPi * kTwoPi / (root * root * root)};
  return result;
}

EnvelopeResult envelope_of(const CycleAmplitudes& cycles) {
  EnvelopeResult result;
  const std::size_t count = cycles.time_s.size(), spans = std::min(kPoints, count / kLeastCycles);
  const auto through = [&](const std::vector<double>& values, std::size_t from, std::size_t n,
                           Index terms) {
    return polynomial(cycles.time_s.data() + from, cycles.weight.data() + from,
                      values.data() + from, n, terms);
  };
  const double omega = cycles.pole.imag() * cycles.sample_rate_hz;
  std::vector<double> times, frequencies, frequency_weights;
  for (std::size_t s = 0; s < spans; ++s) {
    const std::size_t from = count * s / spans, n = count * (s + 1) / spans - from;
    const auto size = through(cycles.log_size, from, n, 2), turn = through(cycles.turn, from, n, 2);
    const double middle = 0.5 * (cycles.time_s[from] + cycles.time_s[from + n - 1]);
    const double rate = -size.coefficients(1), std = size.std(1);
    const double w = omega + turn.coefficients(1), modulus = std::hypot(rate, w);
    times.push_back(middle), frequencies.push_back(w / kTwoPi);
    frequency_weights.push_back(kTwoPi * kTwoPi / (std * std));
    // As in the modes: no free oscillation takes energy in.
    result.points.push_back({middle,
                             std::exp(size.coefficients(0) - rate * middle),
                             {w / kTwoPi, std / kTwoPi},
                             {std::max(0.0, rate / modulus), std / modulus}});
  }
  if (spans < 2) return result;
  const auto drift =
      polynomial(times.data(), frequency_weights.data(), frequencies.data(), spans, 2);
  const double lasted = times.back() - times.front();
  const double widening = spans > 2 ? std::max(1.0, drift.widening) : 1;
  result.frequency_drift_hz = {drift.coefficients(1) * lasted, drift.std(1) * widening * lasted};
  const auto size = through(cycles.log_size, 0, count, 3);
  const double curve = size.coefficients(2) / size.std(2);
  // Under friction damping rises as the motion dies.
  if (curve * curve > kLawGain) result.law = curve < 0 ? DecayLaw::friction : DecayLaw::drag;
  return result;
}

}  // namespace rigfit::signal
