#include "signal/decay/decay_description.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "signal/decay/decay_judgement.h"
#include "signal/decay/decay_warnings.h"
#include "signal/decay/log_decrement.h"
#include "signal/numerics/numbers.h"
#include "signal/sinusoids/decay_search.h"
#include "signal/sinusoids/detected_strength.h"
#include "signal/sinusoids/pole_interval.h"
#include "signal/sinusoids/residual_noise.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Frequency and damping of every mode and their joint covariance, from the fit's.
Eigen::MatrixXd mode_jacobian(const DampedSinusoidsFit& fit, double rate) {
  const auto modes = static_cast<Index>(fit.poles.size());
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(2 * modes, 4 * modes + 2);
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

/// Intervals of the modes `kept`, and standard uncertainties and covariance that go with them.
void widen_by_likelihood(DecayResult& result, const DecaySamples& samples,
                         const DampedSinusoidsFit& fit, const ResidualNoise& noise,
                         const Eigen::MatrixXd& covariance, double false_alarm,
                         const std::vector<std::size_t>& kept, std::vector<DecayMode>& modes) {
  const double factor = result.coverage_factor_95;
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(result.covariance.rows());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    DecayMode& mode = modes[kept[i]];
    const double width = std::max(-fit.poles[kept[i]].real(), 1 / static_cast<double>(fit.samples));
    const double variance = noise.white_equivalent(fit.poles[kept[i]].imag() / kTwoPi);
    PoleEvidence evidence;
    evidence.energy = energy_explained(fit, kept[i]) / std::max(variance, 1e-300);
    evidence.strength = detected_strength(evidence.energy, energy_needed(fit, false_alarm));
    Interval* const intervals[] = {&mode.damping_ratio_interval_95, &mode.frequency_interval_95_hz};
    Estimate* const estimates[] = {&mode.damping_ratio, &mode.frequency_hz};
    for (Index part = 0; part < 2; ++part) {
      const auto k = static_cast<Index>(4 * kept[i]) + 2 + part;
      const double std = std::sqrt(covariance(k, k));
      PoleInterval around{factor, factor};
      // Under 2 % of the line's width the curvature of the likelihood is under 2 % too.
      if (std > 0.02 * width) {
        evidence.std = std;
        around = pole_interval(samples.values, samples.missing, fit,
                               static_cast<Index>(2 * kept[i]) + part, evidence);
      }
      mode.bounded = mode.bounded && around.bounded;
      Estimate& estimate = *estimates[part];
      // More damping is a smaller real part.
      const double below = part == 0 ? around.above : around.below;
      const double above = part == 0 ? around.below : around.above;
      *intervals[part] = {estimate.value - below * estimate.std,
                          estimate.value + above * estimate.std};
      const double wider = 0.5 * (below + above) / factor;
      estimate.std *= wider;
      if (part == 1) mode.damped_frequency_hz.std *= wider;
      scale[static_cast<Index>(2 * i) + 1 - part] = wider;
    }
  }
  result.covariance = scale.asDiagonal() * result.covariance * scale.asDiagonal();
  if (std::any_of(kept.begin(), kept.end(), [&](std::size_t m) { return !modes[m].bounded; })) {
    note(result, "not_bounded",
         "the noise leaves frequency or damping without a bound on one side; the interval ends "
         "where "
         "the search for it did, 19 times the standard uncertainty of a clear signal away or where "
         "nothing would oscillate");
  }
}

}  // namespace

void describe_decay(DecayResult& result, const DecaySamples& samples, const DampedSinusoidsFit& fit,
                    const DecayBand& band, double rate, const DecayOptions& options) {
  const auto noise = residual_noise(fit.residual, fit.degrees);
  const Eigen::MatrixXd covariance = fit_covariance(fit, noise);
  const Eigen::MatrixXd jacobian = mode_jacobian(fit, rate);
  const Eigen::MatrixXd of_modes = jacobian * covariance * jacobian.transpose();
  result.offset = fit.offset;
  result.drift_per_s = fit.drift / static_cast<double>(fit.samples) * rate;
  result.noise_std = std::sqrt(noise.variance);
  result.residual_order = noise.coefficients.size();
  result.degrees_of_freedom = fit.degrees;
  result.coverage_factor_95 = gsl_cdf_tdist_Pinv(0.975, static_cast<double>(fit.degrees));
  result.residual = fit.residual;

  const double seconds = static_cast<double>(fit.samples) / rate;
  const double threshold = detection_threshold(fit.samples, options.false_alarm);
  std::vector<DecayMode> all(fit.poles.size());
  for (std::size_t m = 0; m < fit.poles.size(); ++m) {
    DecayMode& mode = all[m];
    const auto k = static_cast<Index>(2 * m);
    const Complex p = fit.poles[m];
    mode.frequency_hz = {std::abs(p) * rate / kTwoPi, std::sqrt(of_modes(k, k))};
    mode.damping_ratio = {damping_ratio_of(p), std::sqrt(of_modes(k + 1, k + 1))};
    mode.correlation = of_modes(k, k + 1) / std::sqrt(of_modes(k, k) * of_modes(k + 1, k + 1));
    // d delta / d zeta = 2 pi / (1 - zeta^2)^(3/2)
    const double zeta = mode.damping_ratio.value, root = std::sqrt(1 - zeta * zeta);
    mode.log_decrement = {kTwoPi * zeta / root,
                          kTwoPi * mode.damping_ratio.std / (root * root * root)};
    const auto w = static_cast<Index>(4 * m + 3);
    mode.damped_frequency_hz = {p.imag() * rate / kTwoPi,
                                std::sqrt(covariance(w, w)) * rate / kTwoPi};
    mode.amplitude = std::abs(fit.amplitudes[m]);
    mode.phase_rad = std::arg(fit.amplitudes[m]);
    mode.energy = mode_energy(fit, m);
    mode.detection =
        mode.energy / std::max(threshold * noise.white_equivalent(p.imag() / kTwoPi), 1e-300);
    mode.cycles = mode.damped_frequency_hz.value * seconds;
  }
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t l, std::size_t r) { return all[l].energy > all[r].energy; });
  bool decays = false;
  const auto fall = [&](std::size_t m) {
    return -fit.poles[m].real() * static_cast<double>(fit.samples);
  };
  for (std::size_t m : order) decays = decays || fall(m) > 0.5;
  std::vector<std::size_t> kept;
  for (std::size_t m : order) {
    const auto s = static_cast<Index>(4 * m + 2);
    const double fall_std = std::sqrt(covariance(s, s)) * static_cast<double>(fit.samples);
    // Known to change by less than a tenth over the record while others decay: hum.
    const bool steady = decays && std::abs(fall(m)) + 2 * fall_std < 0.1;
    if (steady) {
      result.steady_tones.push_back(all[m]);
    } else if (band.contains(fit.poles[m])) {
      if (fall(m) < -0.05 && fall(m) + 3 * fall_std < 0) {
        if (kept.empty()) {
          refuse(result, "grows",
                 fmt::format(
                     "the oscillation at {:.6g} Hz grows by a factor of {:.3g} over the window: "
                     "this is no free decay, or two modes beat (name a start and end that hold a "
                     "decay, or a whole beat)",
                     all[m].damped_frequency_hz.value, std::exp(-fall(m))));
          return;
        }
        note(result, "grows",
             fmt::format("a weaker oscillation at {:.6g} Hz grows; it is fitted but "
                         "not reported",
                         all[m].damped_frequency_hz.value));
        continue;
      }
      kept.push_back(m);
    }
  }
  if (kept.empty()) {
    refuse(result, "no_decay",
           result.steady_tones.empty() ? "no oscillation in the band"
                                       : "only steady tones in the band, nothing that decays");
    return;
  }
  result.covariance.resize(2 * static_cast<Index>(kept.size()),
                           2 * static_cast<Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i) {
    for (std::size_t k = 0; k < kept.size(); ++k) {
      result.covariance.block<2, 2>(2 * static_cast<Index>(i), 2 * static_cast<Index>(k)) =
          of_modes.block<2, 2>(2 * static_cast<Index>(kept[i]), 2 * static_cast<Index>(kept[k]));
    }
  }
  widen_by_likelihood(result, samples, fit, noise, covariance, options.false_alarm, kept, all);
  const LineSpectrum spectrum = line_spectrum(fit.residual);
  for (std::size_t m : kept) {
    DecayMode& mode = all[m];
    Eigen::VectorXd alone = fit.mode_signal(m);
    alone += fit.residual;  // zero where samples are missing
    const double left = fit.residual_sum_squares;
    const double spread = (alone.array() - alone.mean()).square().sum();
    mode.r_squared = spread > 0 ? 1 - left / spread : 0;
    LogDecrementOptions ruler;
    ruler.noise_std = result.noise_std;
    const auto decrement = log_decrement(alone, rate, mode.damped_frequency_hz.value, ruler);
    mode.damping_ratio_log_decrement = decrement.damping_ratio;
    mode.log_decrement_refusal = decrement.refusal;
    doubt_of(mode, alone, fit.residual, result.residual_order, options.false_alarm);
    mode.company = leaves_company(spectrum, fit.poles[m], options.false_alarm);
    result.modes.push_back(mode);
  }
  if (std::all_of(result.modes.begin(), result.modes.end(),
                  [](const DecayMode& mode) { return mode.doubtful; })) {
    if (result.modes[0].company && result.modes[0].r_squared > 0.3) {
      refuse(
          result, "not_separable",
          fmt::format("what one decay leaves near {:.4g} Hz is no noise: two modes that beat too "
                      "slowly for this record, or one that changes; a longer record or less "
                      "noise is needed",
                      result.modes[0].damped_frequency_hz.value));
      result.modes.clear();
      return;
    }
    refuse(result, "too_noisy", "no oscillation stands out of the noise: " + result.modes[0].doubt);
    result.modes.clear();
    return;
  }
  const std::size_t main = kept.front();
  const double f = fit.poles[main].imag() / kTwoPi;
  result.signal_to_noise_db =
      10 * std::log10(0.5 * std::norm(fit.amplitudes[main]) / std::max(noise.variance, 1e-300));
  // Noise near the mode, read beside it: what the model leaves at the mode itself is not noise.
  DecaySearchOptions beside;
  beside.damped = false, beside.candidates = 1;
  beside.lowest = std::max(0.0, f - 0.05), beside.highest = std::min(0.5, f + 0.05);
  const auto floor = search_lines(spectrum, beside);
  result.envelope =
      mode_envelope(fit, main, rate, floor.empty() ? noise.variance : floor.front().noise_variance,
                    options.envelope);
}

}  // namespace rigfit::signal
