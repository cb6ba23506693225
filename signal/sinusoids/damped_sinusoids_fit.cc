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

Eigen::MatrixXd DampedSinusoidsFit::jacobian_rows(Index first, Index count) const {
  Eigen::MatrixXd rows(count, jacobian_gram.rows());
  const auto modes = static_cast<Index>(poles.size());
  for (Index m = 0; m < modes; ++m) {
    const std::complex<double> q = std::exp(poles[static_cast<std::size_t>(m)]);
    std::complex<double> z;
    for (Index l = 0; l < count; ++l) {
      const auto j = static_cast<double>(first + l);
      z = l % kRestart == 0 ? std::exp(poles[static_cast<std::size_t>(m)] * j) : z * q;
      const std::complex<double> moved = j * amplitudes[static_cast<std::size_t>(m)] * z;
      rows.row(l).segment<4>(4 * m) << z.real(), -z.imag(), moved.real(), -moved.imag();
    }
  }
  for (Index l = 0; l < count && rows.cols() > 4 * modes; ++l) {
    rows(l, 4 * modes) = 1;
    if (rows.cols() > 4 * modes + 1) {
      rows(l, 4 * modes + 1) = static_cast<double>(first + l) / static_cast<double>(samples);
    }
  }
  return rows;
}

}  // namespace rigfit::signal
