#include "signal/decay/decay_description.h"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "signal/envelope/log_decrement.h"
#include "signal/numerics/numbers.h"
#include "signal/sinusoids/decay_search.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Known to change by less than this over the window while others decay: a steady tone.
constexpr double kSteady = 0.1;

/// d(f, zeta) / d(Re p, Im p) of every mode.
Eigen::MatrixXd mode_jacobian(const DampedSinusoidsFit& fit, double rate) {
  const auto modes = static_cast<Index>(fit.poles.size());
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(2 * modes, 4 * modes);
  for (Index m = 0; m < modes; ++m) {
    const Complex p = fit.poles[static_cast<std::size_t>(m)];
    const double s = p.real(), w = p.imag(), r = std::abs(p);
    jacobian.block<2, 2>(2 * m, 4 * m + 2) << rate / kTwoPi * s / r, rate / kTwoPi * w / r,
        -w * w / (r * r * r), s * w / (r * r * r);
  }
  return jacobian;
}

Interval around(const Estimate& e, double factor) {
  return {e.value - factor * e.std, e.value + factor * e.std};
}

DecayMode described(const DampedSinusoidsFit& fit, std::size_t m, const Eigen::Matrix2d& covariance,
                    double rate, double factor) {
  DecayMode mode;
  const auto w = static_cast<Index>(4 * m + 3);
  const Complex p = fit.poles[m];
  mode.frequency_hz = {std::abs(p) * rate / kTwoPi, std::sqrt(covariance(0, 0))};
  mode.damping_ratio = {damping_ratio_of(p), std::sqrt(covariance(1, 1))};
  mode.damped_frequency_hz = {p.imag() * rate / kTwoPi,
                              std::sqrt(fit.covariance(w, w)) * rate / kTwoPi};
  mode.frequency_interval_95_hz = around(mode.frequency_hz, factor);
  mode.damping_ratio_interval_95 = around(mode.damping_ratio, factor);
  mode.amplitude = std::abs(fit.amplitudes[m]);
  mode.phase_rad = std::arg(fit.amplitudes[m]);
  mode.energy = mode_energy(fit, m);
  mode.cycles = mode.damped_frequency_hz.value * static_cast<double>(fit.samples) / rate;
  return mode;
}

/// What the others leave and this mode explains of it.
void describe_alone(DecayMode& mode, const DampedSinusoidsFit& fit, std::size_t m, double rate) {
  const Eigen::VectorXd alone = fit.mode_signal(m) + fit.residual;  // residual 0 where missing
  const double spread = (alone.array() - alone.mean()).square().sum();
  mode.r_squared = spread > 0 ? 1 - fit.residual_sum_squares / spread : 0;
  LogDecrementOptions ruler;
  ruler.noise_std = std::sqrt(fit.variance());
  const auto swings = log_decrement(alone, rate, mode.damped_frequency_hz.value, ruler);
  mode.damping_ratio_log_decrement = swings.damping_ratio;
  mode.log_decrement_refusal = swings.refusal;
  if (swings.refusal.empty() && !(swings.damping_ratio.value >= 0)) {
    mode.damping_ratio_log_decrement = {};
    mode.log_decrement_refusal = "the swings do not fall";
  }
  // A free oscillation takes no energy in: the likely values are those from zero on.
  auto& zeta = mode.damping_ratio;
  auto& interval = mode.damping_ratio_interval_95;
  if (zeta.value < 0) zeta.value = 0, interval.high = std::max(interval.high, zeta.std);
  interval.low = std::max(0.0, interval.low);
  // d delta / d zeta = 2 pi / (1 - zeta^2)^(3/2)
  const double root = std::sqrt(1 - zeta.value * zeta.value);
  mode.log_decrement = {kTwoPi * zeta.value / root, kTwoPi * zeta.std / (root * root * root)};
}

}  // namespace

void describe_decay(DecayResult& result, const DampedSinusoidsFit& fit, const DecayBand& band,
                    double rate, const EnvelopeOptions& options) {
  const auto samples = static_cast<double>(fit.samples);
  const double factor = gsl_cdf_tdist_Pinv(0.975, fit.noise_degrees);
  const Eigen::MatrixXd jacobian = mode_jacobian(fit, rate);
  const Eigen::MatrixXd covariance = jacobian * fit.covariance * jacobian.transpose();
  result.offset = fit.offset;
  result.drift_per_s = fit.drift / samples * rate;
  result.offset_decays_s = fit.relaxation ? 1 / (*fit.relaxation * rate) : 0;
  result.noise_std = std::sqrt(fit.variance());
  result.degrees_of_freedom = fit.degrees;
  result.coverage_factor_95 = factor;
  result.residual = fit.residual;

  std::vector<DecayMode> all;
  for (std::size_t m = 0; m < fit.poles.size(); ++m) {
    const auto k = static_cast<Index>(2 * m);
    all.push_back(described(fit, m, covariance.block<2, 2>(k, k), rate, factor));
  }
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t l, std::size_t r) { return all[l].energy > all[r].energy; });
  // Time constants in the window, and their standard uncertainty.
  const auto fall = [&](std::size_t m) { return -fit.poles[m].real() * samples; };
  const auto fall_std = [&](std::size_t m) {
    const auto s = static_cast<Index>(4 * m + 2);
    return std::sqrt(fit.covariance(s, s)) * samples;
  };
  const bool decays =
      std::any_of(order.begin(), order.end(), [&](std::size_t m) { return fall(m) > 0.5; });
  std::vector<std::size_t> kept;
  for (const std::size_t m : order) {
    const bool grows = fall(m) < -0.05 && fall(m) + 3 * fall_std(m) < 0;
    if (decays && std::abs(fall(m)) + 2 * fall_std(m) < kSteady) {
      result.steady_tones.push_back(all[m]);
    } else if (band.contains(fit.poles[m]) && !grows) {
      kept.push_back(m);
    }
  }
  const auto count = static_cast<Index>(kept.size());
  result.covariance.resize(2 * count, 2 * count);
  for (Index i = 0; i < count; ++i) {
    for (Index k = 0; k < count; ++k) {
      result.covariance.block<2, 2>(2 * i, 2 * k) =
          covariance.block<2, 2>(2 * static_cast<Index>(kept[static_cast<std::size_t>(i)]),
                                 2 * static_cast<Index>(kept[static_cast<std::size_t>(k)]));
    }
  }
  for (const std::size_t m : kept) {
    describe_alone(all[m], fit, m, rate);
    result.modes.push_back(all[m]);
  }
  if (kept.empty()) return;
  const std::size_t main = kept.front();
  result.signal_to_noise_db =
      10 * std::log10(0.5 * std::norm(fit.amplitudes[main]) / std::max(fit.noise[main], 1e-300));
  result.envelope =
      mode_envelope(fit, main, rate, noise_beside(fit, fit.poles[main].imag() / kTwoPi), options);
}

}  // namespace rigfit::signal
