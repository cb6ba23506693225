// What a fit of damped sinusoids gives back in samples: its modes and the columns of its Jacobian.
#include <algorithm>
#include <cmath>

#include "signal/sinusoids/damped_sinusoids.h"

namespace rigfit::signal {
namespace {

using Eigen::Index;

// Samples of z^j by products before the power is computed anew: rounding grows with them.
constexpr Index kRestart = 256;

}  // namespace

Eigen::VectorXd DampedSinusoidsFit::mode_signal(std::size_t m) const {
  Eigen::VectorXd signal(samples);
  for (Index start = 0; start < samples; start += kRestart) {
    std::complex<double> z = amplitudes[m] * std::exp(poles[m] * static_cast<double>(start));
    const std::complex<double> q = std::exp(poles[m]);
    for (Index j = start; j < std::min(samples, start + kRestart); ++j) {
      signal(j) = z.real();
      z = std::complex<double>(z.real() * q.real() - z.imag() * q.imag(),
                               z.real() * q.imag() + z.imag() * q.real());
    }
  }
  return signal;
}

Eigen::VectorXd DampedSinusoidsFit::jacobian_column(Index k) const {
  const auto modes = static_cast<Index>(poles.size());
  if (k >= 4 * modes) {
    if (k == 4 * modes) return Eigen::VectorXd::Ones(samples);
    return Eigen::VectorXd::LinSpaced(samples, 0, static_cast<double>(samples - 1)) /
           static_cast<double>(samples);
  }
  const auto m = static_cast<std::size_t>(k / 4);
  const int which = static_cast<int>(k % 4);
  const std::complex<double> factor =
      (which % 2 ? std::complex<double>(0, 1) : std::complex<double>(1)) *
      (which < 2 ? 1.0 : amplitudes[m]);
  Eigen::VectorXd column(samples);
  for (Index start = 0; start < samples; start += kRestart) {
    std::complex<double> z = std::exp(poles[m] * static_cast<double>(start)) * factor;
    const std::complex<double> q = std::exp(poles[m]);
    for (Index j = start; j < std::min(samples, start + kRestart); ++j) {
      column(j) = which < 2 ? z.real() : static_cast<double>(j) * z.real();
      z = std::complex<double>(z.real() * q.real() - z.imag() * q.imag(),
                               z.real() * q.imag() + z.imag() * q.real());
    }
  }
  return column;
}

double DampedSinusoidsFit::jacobian(Index sample, Index k) const {
  const auto modes = static_cast<Index>(poles.size());
  const auto j = static_cast<double>(sample);
  if (k >= 4 * modes) return k == 4 * modes ? 1 : j / static_cast<double>(samples);
  const auto m = static_cast<std::size_t>(k / 4);
  const int which = static_cast<int>(k % 4);
  const std::complex<double> factor =
      (which % 2 ? std::complex<double>(0, 1) : std::complex<double>(1)) *
      (which < 2 ? 1.0 : amplitudes[m]);
  return (which < 2 ? 1 : j) * (std::exp(poles[m] * j) * factor).real();
}

}  // namespace rigfit::signal
