#include "signal/decay/decay_excitation.h"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "signal/decay/decay_hits.h"
#include "signal/numerics/factorisations.h"

namespace rigfit::signal {

using Complex = std::complex<double>;
using Eigen::Index;

Index excitation_block(Index samples, double w) {
  constexpr Index kMostBlocks = 40;
  return std::max(averaging_cycle(w), (samples + kMostBlocks - 1) / kMostBlocks);
}

Excitation excitation_at(const Eigen::Ref<const Eigen::VectorXd>& residual, double w,
                         double noise_variance) {
  Excitation found;
  const Index n = residual.size(), block = excitation_block(n, w), count = n / block;
  const Index terms = std::min<Index>(7, count / 4);
  if (terms < 1) return found;
  const RunningAmplitude running(residual, w);
  Eigen::VectorXcd z(count);
  for (Index k = 0; k < count; ++k) z(k) = running.over(k * block, (k + 1) * block);
  Eigen::MatrixXd powers(count, terms);  // Legendre polynomials
  for (Index k = 0; k < count; ++k) {
    const double t = 2 * (static_cast<double>(k) + 0.5) / static_cast<double>(count) - 1;
    for (Index p = 0; p < terms; ++p) {
      const auto order = static_cast<double>(p);
      powers(k, p) =
          p == 0 ? 1
          : p == 1
              ? t
              : ((2 * order - 1) * t * powers(k, p - 1) - (order - 1) * powers(k, p - 2)) / order;
    }
  }
  const Eigen::MatrixXd basis = thin_qr(powers).Q;
  const Eigen::VectorXcd left = z - basis * (basis.transpose() * z);
  const double sum = left.squaredNorm();
  const auto degrees = static_cast<double>(2 * (count - terms));
  const double expected = 4 * noise_variance / static_cast<double>(block);
  found.blocks = count;
  found.over_noise = sum / (0.5 * degrees * std::max(expected, 1e-300));
  found.amplitude = std::sqrt(std::max(0.0, sum / (0.5 * degrees) - expected));
  found.later_share = sum > 0 ? left.tail(count / 2).squaredNorm() / sum : 0.5;
  // Sum of |z|^2 over half its mean is chi-squared. The density beside the mode is itself known to
  // some ten per cent only.
  found.significant =
      2 * sum / std::max(1.3 * expected, 1e-300) > gsl_cdf_chisq_Qinv(1e-6, degrees);
  return found;
}

}  // namespace rigfit::signal
