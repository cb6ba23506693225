#include "signal/decay/decay_excitation.h"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "signal/decay/decay_hits.h"
#include "signal/numerics/factorisations.h"
#include "signal/numerics/numbers.h"
#include "signal/sinusoids/decay_search.h"

namespace rigfit::signal {

using Complex = std::complex<double>;
using Eigen::Index;

namespace {

// Blocks of the record at most.
constexpr Index kBlocksAtMost = 40;

/// Median density beside frequency w; 0: too few lines there.
double noise_beside(const Eigen::Ref<const Eigen::VectorXd>& residual, double w, double block) {
  const LineSpectrum spectrum = line_spectrum(residual);
  std::vector<double> sides[2];
  for (Index k = 1; k < spectrum.power.size(); ++k) {
    const double apart = (static_cast<double>(k) / spectrum.lines_per_cycle - w / kTwoPi) * block;
    if (std::abs(apart) > 1 && std::abs(apart) < 4) sides[apart > 0].push_back(spectrum.power(k));
  }
  double most = 0;
  for (auto& powers : sides) {
    if (powers.size() < 8) continue;
    const auto middle = powers.begin() + static_cast<std::ptrdiff_t>(powers.size() / 2);
    std::nth_element(powers.begin(), middle, powers.end());
    // Median of an exponential distribution of mean 2 s^2 is 2 s^2 ln 2.
    most = std::max(most, *middle / (2 * std::numbers::ln2));
  }
  return most;
}

}  // namespace

Excitation excitation_at(const Eigen::Ref<const Eigen::VectorXd>& residual, double w) {
  Excitation found;
  const Index n = residual.size();
  const Index block = std::max(averaging_cycle(w), (n + kBlocksAtMost - 1) / kBlocksAtMost);
  const Index count = n / block;
  double noise_variance = noise_beside(residual, w, static_cast<double>(block));
  if (!(noise_variance > 0)) noise_variance = residual.squaredNorm() / static_cast<double>(n);
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
