#include "signal/decay/decay_description.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>

#include "signal/numerics/numbers.h"
#include "signal/sinusoids/decay_search.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// d (f, zeta) of every mode / d parameters of the fit.
Eigen::MatrixXd mode_jacobian(const DampedSinusoidsFit& fit, double rate) {
  const auto modes = static_cast<Index>(fit.poles.size());
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(2 * modes, fit.unit_covariance.rows());
  for (Index m = 0; m < modes; ++m) {
    const Complex p = fit.poles[static_cast<std::size_t>(m)];
    const double s = p.real(), w = p.imag(), r = std::abs(p);
    jacobian(2 * m, 4 * m + 2) = rate / kTwoPi * s / r;
    jacobian(2 * m, 4 * m + 3) = rate / kTwoPi * w / r;
    jacobian(2 * m + 1, 4 * m + 2) = -w * w / (r * r * r);
    jacobian(2 * m + 1, 4 * m + 3) = s * w / (r * r * r);
  }
  return jacobian;
}

/// How far the residual's density within the mode's line exceeds `variance`, 1 where noise would
/// show as much. Its two middle lines are left out: there the fit takes the residual away.
double local_excess(const LineSpectrum& residual, Complex pole, double variance) {
  const auto n = static_cast<double>(residual.samples);
  const double reach = std::max(4.0, -2 * pole.real() / kTwoPi * n);  // lines of 1 / N
  const double centre = pole.imag() / kTwoPi * residual.lines_per_cycle;
  const double per_line = residual.lines_per_cycle / n;
  double sum = 0;
  Index count = 0;
  const auto first = std::max<Index>(1, static_cast<Index>(std::ceil(centre - reach * per_line)));
  const auto last = std::min<Index>(residual.power.size() - 1,
                                    static_cast<Index>(std::floor(centre + reach * per_line)));
  for (Index k = first; k <= last; ++k) {
    if (std::abs(static_cast<double>(k) - centre) < per_line) continue;
    sum += residual.power(k), ++count;
  }
  if (count == 0) return 1;
  const double ratio = 0.5 * sum / static_cast<double>(count) / std::max(variance, 1e-300);
  const double degrees = 2 * static_cast<double>(count) / per_line;
  // The density beside the mode is itself known to some ten per cent only.
  return ratio * degrees > 1.3 * gsl_cdf_chisq_Qinv(1e-4, degrees) ? std::max(1.0, ratio) : 1;
}

/// Whether what one damped sinusoid leaves has a line beside it that noise would not show.
bool leaves_company(const LineSpectrum& residual, Complex pole, double false_alarm) {
  const double f = pole.imag() / kTwoPi, n = static_cast<double>(residual.samples);
  const double reach = 2 / n - 2 * pole.real() / kTwoPi;
  DecaySearchOptions beside;
  beside.damped = false, beside.candidates = 1;
  beside.lowest = std::max(0.0, f - reach), beside.highest = std::min(0.5, f + reach);
  beside.energy_over_noise = detection_threshold(residual.samples, false_alarm);
  return !search_lines(residual, beside).empty();
}

/// Whether coloured noise passes for the mode: `alone`, what the other modes leave, is as well
/// predicted by an autoregression of the residual's own order. (Likelihood ratio, four unknowns,
/// over all cells of the search.)
std::string doubt_of(const DecayMode& mode, const Eigen::VectorXd& alone,
                     const Eigen::VectorXd& residual, Index order, double false_alarm) {
  // A mode that explains most of what is there is no noise; its residual's colour is its own.
  if (order == 0 || mode.r_squared > 0.8) return {};
  const double without = prediction_error(alone, order), with = prediction_error(residual, order);
  if (!(with > 0)) return {};
  const double gain = static_cast<double>(alone.size()) * std::log(without / with);
  // exp(threshold / 2) is the number of cells over the false alarm.
  const double chance = std::exp(-0.5 * detection_threshold(alone.size(), false_alarm));
  const double needed = gsl_cdf_chisq_Qinv(chance, 4);
  if (gain > needed) return {};
  return fmt::format(
      "noise of the colour of the residual would show as much at {:.4g} Hz (evidence {:.2g} of "
      "what is asked for)",
      mode.damped_frequency_hz.value, std::max(0.0, gain) / needed);
}

}  // namespace

double DescribedFit::noise_beside(double w) const {
  DecaySearchOptions beside;
  beside.damped = false, beside.candidates = 1;
  beside.lowest = std::max(0.0, w / kTwoPi - 0.05);
  beside.highest = std::min(0.5, w / kTwoPi + 0.05);
  const auto floor = search_lines(residual, beside);
  return floor.empty() ? noise.variance : floor.front().noise_variance;
}

DescribedFit describe_fit(const DampedSinusoidsFit& fit, double rate, double false_alarm) {
  DescribedFit out{fit, false_alarm, {}, {}, {}, {}, {}, {}, {}};
  out.noise = residual_noise(fit.residual, fit.degrees);
  out.residual = line_spectrum(fit.residual);
  const Eigen::MatrixXd covariance = fit_uncertainty(fit, out.noise).widened();
  const Eigen::MatrixXd jacobian = mode_jacobian(fit, rate);
  out.covariance = jacobian * covariance * jacobian.transpose();
  const double factor = gsl_cdf_tdist_Pinv(0.975, static_cast<double>(fit.degrees));
  const auto n = static_cast<double>(fit.samples);
  Eigen::VectorXd scale(out.covariance.rows());
  for (std::size_t m = 0; m < fit.poles.size(); ++m) {
    const Complex p = fit.poles[m];
    const auto k = static_cast<Index>(2 * m), s = 2 * k + 2, w = s + 1;
    const double variance = out.noise.white_equivalent(p.imag() / kTwoPi);
    const double wider = std::sqrt(local_excess(out.residual, p, variance));
    scale.segment<2>(k).setConstant(wider);
    out.fall.push_back(-p.real() * n), out.fall_std.push_back(std::sqrt(covariance(s, s)) * n);

    DecayMode mode;
    const double to_hz = rate / kTwoPi;
    mode.frequency_hz = {std::abs(p) * to_hz, wider * std::sqrt(out.covariance(k, k))};
    mode.damping_ratio = {damping_ratio_of(p), wider * std::sqrt(out.covariance(k + 1, k + 1))};
    mode.damped_frequency_hz = {p.imag() * to_hz, wider * std::sqrt(covariance(w, w)) * to_hz};
    mode.correlation =
        out.covariance(k, k + 1) / std::sqrt(out.covariance(k, k) * out.covariance(k + 1, k + 1));
    const auto interval = [&](const Estimate& e) {
      return Interval{e.value - factor * e.std, e.value + factor * e.std};
    };
    mode.frequency_interval_95_hz = interval(mode.frequency_hz);
    // A free oscillation takes no energy in: the likely values are those from zero on. Once the
    // record holds the decay, what the damping is uncertain by grows with it: then its logarithm
    // has the interval.
    auto& zeta = mode.damping_ratio;
    auto& within = mode.damping_ratio_interval_95;
    within = interval(zeta);
    if (zeta.value < 0) zeta.value = 0, within.high = std::max(within.high, zeta.std);
    within.low = std::max(0.0, within.low);
    if (out.fall.back() > 1) {
      const double times = std::exp(factor * zeta.std / zeta.value);
      within = {zeta.value / times, zeta.value * times};
    }
    // d delta / d zeta = 2 pi / (1 - zeta^2)^(3/2)
    const double root = std::sqrt(1 - zeta.value * zeta.value);
    mode.log_decrement = {kTwoPi * zeta.value / root, kTwoPi * zeta.std / (root * root * root)};
    mode.amplitude = std::abs(fit.amplitudes[m]), mode.phase_rad = std::arg(fit.amplitudes[m]);
    mode.energy = mode_energy(fit, m);
    mode.detection =
        mode.energy / std::max(detection_threshold(fit.samples, false_alarm) * variance, 1e-300);
    mode.cycles = p.imag() / kTwoPi * n;

    Eigen::VectorXd alone = fit.mode_signal(m);
    alone += fit.residual;  // zero where samples are missing
    const double spread = (alone.array() - alone.mean()).square().sum();
    mode.r_squared = spread > 0 ? 1 - fit.residual_sum_squares / spread : 0;
    const auto cycles = cycle_amplitudes(alone, rate, p, out.noise_beside(p.imag()));
    const auto decrement = log_decrement(cycles);
    mode.damping_ratio_log_decrement = decrement.damping_ratio;
    mode.log_decrement_refusal = decrement.refusal;
    out.envelopes.push_back(envelope_of(cycles));
    mode.doubt = doubt_of(mode, alone, fit.residual, out.noise.coefficients.size(), false_alarm);
    mode.doubtful = !mode.doubt.empty();
    mode.company = leaves_company(out.residual, p, false_alarm);
    out.modes.push_back(std::move(mode));
  }
  out.covariance = scale.asDiagonal() * out.covariance * scale.asDiagonal();
  return out;
}

}  // namespace rigfit::signal
