#include "signal/spectra/force_noise.h"

#include <gsl/gsl_cdf.h>

#include "signal/spectra/fft.h"
#include "signal/spectra/line_means.h"
#include "signal/spectra/window.h"

namespace rigfit::signal {
namespace {

/// Spectrum of an autocovariance of n lags: n + 1 lines, half a line of a block apart.
ArrayXd power_of(const ArrayXd& r) {
  const Index n = r.size();
  VectorXd time(2 * n);
  time << r.matrix(), 0, r.tail(n - 1).reverse().matrix();
  return real_spectra(time, 2 * n).real().array().max(0.0);
}

/// The reverse.
ArrayXd lags_of(const ArrayXd& power) {
  RealFft fft(2 * (power.size() - 1));
  fft.spectrum() = power.matrix().cast<Complex>();
  fft.inverse();
  return fft.time().head(power.size() - 1).array();
}

/// Adds the power of samples on the lines of `power`, whose lags are their correlation.
void add_power(const VectorXd& samples, ArrayXd& power) {
  power += real_spectra(samples, 2 * (power.size() - 1)).array().abs2();
}

Index samples_of(const FrfBlock& block, Index n) {
  return std::min(n, static_cast<Index>(block.force.size()));
}

/// Sum over the blocks of the correlation of their windows with themselves.
ArrayXd window_lags(std::span<const FrfBlock> blocks, Index n, const VectorXd& exponential) {
  ArrayXd power = ArrayXd::Zero(n + 1);
  for (const FrfBlock& block : blocks) {
    VectorXd window = block.force_last < 0
                          ? VectorXd(VectorXd::Ones(n))
                          : force_window(n, block.force_first, block.force_last, block.force_taper);
    window.array() *= exponential.array();
    add_power(window.head(samples_of(block, n)), power);
  }
  return lags_of(power);
}

/// Autocovariance of the noise; empty where too little of it is seen.
ArrayXd noise_lags(std::span<const FrfBlock> blocks, Index n) {
  ArrayXd values = ArrayXd::Zero(n + 1), counts = values;
  double total = 0;
  for (const FrfBlock& block : blocks) {
    if (block.pulse_last < block.pulse_first) return {};
    const Index length = samples_of(block, n);
    const Index first = std::clamp<Index>(block.pulse_first, 0, length);
    const Index last = std::clamp<Index>(block.pulse_last + 1, first, length);
    VectorXd outside = VectorXd::Ones(length);
    outside.segment(first, last - first).setZero();
    total += outside.sum();
    add_power(outside, counts);
    const Map<const VectorXd> x(block.force.data(), length);
    // A constant lies in the line at 0 Hz alone; smoothing would spread it over its neighbours.
    const double mean = x.dot(outside) / std::max(outside.sum(), 1.0);
    add_power(((x.array() - mean) * outside.array()).matrix(), values);
  }
  if (total < static_cast<double>(kFewestForNoise)) return {};
  const ArrayXd r = lags_of(values), pairs = lags_of(counts);
  // Lags that few pairs make up are left out: they scatter without bound.
  const double least = std::max(0.5 * kFewestForNoise, 0.02 * total);
  return (pairs >= least).select(r / pairs.max(1.0), 0.0);
}

/// Largest power of a line over the median that noise of `freedom` degrees of freedom gives, but
/// for once in a million.
double most_of_noise(double freedom) {
  return gsl_cdf_chisq_Qinv(1e-6, freedom) / gsl_cdf_chisq_Pinv(0.5, freedom);
}

/// Autocovariance without tones: lines are cut to what noise gives.
ArrayXd without_tones(const ArrayXd& r, double freedom, Index smoothing_lines) {
  // A Gaussian over lags, two lines wide: a tone's leakage ends some eight lines from it.
  const auto n = static_cast<double>(r.size());
  const ArrayXd angle = ArrayXd::LinSpaced(r.size(), 0, n - 1) * (4 * EIGEN_PI / n);
  const ArrayXd power = power_of(r * (-0.5 * angle.square()).exp());
  return lags_of(power.min(most_of_noise(freedom) * median_over_lines(power, 4 * smoothing_lines)));
}

ArrayXd every_second(const ArrayXd& values) {
  return values(Eigen::seqN(0, (values.size() + 1) / 2, 2));
}

}  // namespace

ForceNoise force_noise_power(std::span<const FrfBlock> blocks, Index n, const VectorXd& exponential,
                             Index smoothing_lines) {
  const ArrayXd r = noise_lags(blocks, n);
  if (r.size() == 0) return {};
  const auto count = static_cast<double>(blocks.size());
  const ArrayXd window = window_lags(blocks, n, exponential) / count;
  const ArrayXd quiet = without_tones(r, 2 * count, smoothing_lines);
  const ArrayXd smooth = mean_over_lines(every_second(power_of(quiet * window)), smoothing_lines);
  const ArrayXd tones = every_second(power_of((r - quiet) * window));
  return {(tones > most_of_noise(2 * count) * smooth).select(smooth + tones, smooth), smooth};
}

}  // namespace rigfit::signal
