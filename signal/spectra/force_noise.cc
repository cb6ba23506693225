#include "signal/spectra/force_noise.h"

#include <algorithm>

#include "signal/spectra/fft.h"
#include "signal/spectra/window.h"

namespace rigfit::signal {
namespace {
using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::VectorXd;

/// Correlation of samples with themselves, summed over signals, lags 0 .. length - 1.
class Correlation {
 public:
  explicit Correlation(Index length) : fft_(2 * length), power_(ArrayXd::Zero(fft_.lines())) {}

  void add(const Eigen::Ref<const VectorXd>& samples) {
    auto time = fft_.time();
    time.setZero();
    time.head(samples.size()) = samples;
    fft_.forward();
    power_ += fft_.spectrum().array().abs2();
  }
  [[nodiscard]] ArrayXd lags() {
    fft_.spectrum() = power_.matrix().cast<std::complex<double>>();
    fft_.inverse();
    return fft_.time().head(fft_.length() / 2).array();
  }

 private:
  RealFft fft_;
  ArrayXd power_;
};

Index samples_of(const FrfBlock& block, Index n) {
  return std::min(n, static_cast<Index>(block.force.size()));
}

/// Sum over the blocks of the correlation of their windows with themselves.
ArrayXd window_lags(std::span<const FrfBlock> blocks, Index n, const VectorXd& exponential) {
  const bool same = std::all_of(blocks.begin(), blocks.end(), [&](const FrfBlock& block) {
    return block.force_last < 0 && samples_of(block, n) == n;
  });
  if (same && exponential.size() == 0) {
    return static_cast<double>(blocks.size()) * ArrayXd::LinSpaced(n, static_cast<double>(n), 1);
  }
  Correlation correlation(n);
  for (const FrfBlock& block : blocks) {
    VectorXd window = block.force_last < 0
                          ? VectorXd(VectorXd::Ones(n))
                          : force_window(n, block.force_first, block.force_last, block.force_taper);
    if (exponential.size() > 0) window.array() *= exponential.array();
    correlation.add(window.head(samples_of(block, n)));
  }
  return correlation.lags();
}

/// Autocovariance of the noise; empty where too little of it is seen.
ArrayXd noise_lags(std::span<const FrfBlock> blocks, Index n) {
  constexpr double kFewest = 32;  // a variance from fewer is off by a quarter and more
  Correlation values(n), counts(n);
  double total = 0;
  for (const FrfBlock& block : blocks) {
    if (block.pulse_last < block.pulse_first) return {};
    const Index length = samples_of(block, n);
    const Index first = std::clamp<Index>(block.pulse_first, 0, length);
    const Index last = std::clamp<Index>(block.pulse_last + 1, first, length);
    VectorXd outside = VectorXd::Ones(length);
    outside.segment(first, last - first).setZero();
    total += outside.sum();
    counts.add(outside);
    const Eigen::Map<const VectorXd> x(block.force.data(), length);
    // A constant lies in the line at 0 Hz alone; smoothing would spread it over its neighbours.
    const double mean = x.dot(outside) / std::max(outside.sum(), 1.0);
    values.add(((x.array() - mean) * outside.array()).matrix());
  }
  if (total < kFewest) return {};
  ArrayXd r = values.lags();
  const ArrayXd pairs = counts.lags();
  // Lags that few pairs make up are left out: they scatter without bound.
  const double least = std::max(kFewest / 4, 0.02 * total);
  return (pairs >= least).select(r / pairs.max(1.0), 0.0);
}

}  // namespace

VectorXd force_noise_power(std::span<const FrfBlock> blocks, Index n, const VectorXd& exponential,
                           Index smoothing_lines) {
  ArrayXd r = noise_lags(blocks, n);
  if (r.size() == 0) return {};
  r *= window_lags(blocks, n, exponential);
  // A Gaussian over lags averages over lines: its transform has the rms width of a box of
  // `smoothing_lines` on either side.
  const double width = static_cast<double>(smoothing_lines) / std::sqrt(3.0);
  const ArrayXd angle = ArrayXd::LinSpaced(n, 0, static_cast<double>(n - 1)) *
                        (2 * EIGEN_PI * width / static_cast<double>(n));
  r *= (-0.5 * angle.square()).exp();
  RealFft fft(2 * n);
  auto time = fft.time();
  time.setZero();
  time.head(n) = r.matrix();
  time.tail(n - 1) = r.tail(n - 1).reverse().matrix();
  fft.forward();
  const double scale = 1 / static_cast<double>(blocks.size());
  VectorXd power(n / 2 + 1);
  for (Index k = 0; k < power.size(); ++k) {
    power[k] = scale * std::max(0.0, fft.spectrum()[2 * k].real());
  }
  return power;
}

}  // namespace rigfit::signal
