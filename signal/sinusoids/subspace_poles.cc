#include "signal/sinusoids/subspace_poles.h"

#include <gsl/gsl_cdf.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "signal/numerics/factorisations.h"
#include "signal/numerics/numbers.h"
#include "signal/numerics/power_sums.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr Index kMostBlocks = 64;
constexpr Index kFewestBlocks = 12;
// A sinusoid has fallen by e^-4 then.
constexpr double kTimeConstants = 4;

struct Blocks {
  Eigen::VectorXcd z;
  Index length = 1;
};

// Means over blocks of half cycles, of which the negative frequency has whole cycles.
Blocks demodulated(const Eigen::Ref<const Eigen::VectorXd>& y, Complex pole) {
  const double half_cycle = 0.5 * kTwoPi / pole.imag();
  const double lasts = pole.real() < 0 ? kTimeConstants / -pole.real() : 1e300;
  const auto samples = static_cast<Index>(std::min(static_cast<double>(y.size()), lasts));
  Blocks blocks;
  const double halves = std::ceil(
      std::max(1.0, static_cast<double>(samples) / static_cast<double>(kMostBlocks) / half_cycle));
  blocks.length = std::max<Index>(1, static_cast<Index>(std::lround(halves * half_cycle)));
  const Index count = samples / blocks.length;
  blocks.z.resize(count);
  const Eigen::VectorXcd turn = powers(Complex(0, -pole.imag()), count * blocks.length);
  for (Index k = 0; k < count; ++k) {
    const Index from = k * blocks.length;
    const auto own = y.segment(from, blocks.length);
    const auto z = turn.segment(from, blocks.length);
    blocks.z(k) =
        Complex(own.dot(z.real()), own.dot(z.imag())) * (2 / static_cast<double>(blocks.length));
  }
  return blocks;
}

}  // namespace

double pair_evidence(const Eigen::Ref<const Eigen::VectorXd>& residual, Complex pole) {
  const Blocks blocks = demodulated(residual, pole);
  const Index count = blocks.z.size();
  if (count < kFewestBlocks) return 0;
  Eigen::MatrixXd columns(count, 4);
  for (Index k = 0; k < count; ++k) {
    const double t = (static_cast<double>(k) + 0.5) / static_cast<double>(count);
    const double fall = std::exp(pole.real() * t * static_cast<double>(count * blocks.length));
    columns.row(k) << fall, fall * t, fall * t * t, fall * t * t * t;
  }
  const Eigen::MatrixXd basis = thin_qr(columns).Q;
  const Eigen::MatrixXd re = basis.transpose() * blocks.z.real(),
                        im = basis.transpose() * blocks.z.imag();
  // The fit has taken the first two; what rounding of the blocks leaves of them does not count.
  const double explained = re.bottomRows(2).squaredNorm() + im.bottomRows(2).squaredNorm();
  const double rest = std::max(0.0, blocks.z.squaredNorm() - re.squaredNorm() - im.squaredNorm());
  const auto degrees = static_cast<double>(2 * count - 8);
  if (!(rest > 0) || gsl_cdf_fdist_Q(explained / 4 / (rest / degrees), 4, degrees) > 1e-5) return 0;
  // E|z|^2 = 4 s^2 / length, half of it in each part.
  return rest / degrees * static_cast<double>(blocks.length) / 2;
}

std::vector<Complex> pair_of_poles(const Eigen::Ref<const Eigen::VectorXd>& y, Complex pole) {
  const Blocks blocks = demodulated(y, pole);
  const Index count = blocks.z.size();
  if (count < kFewestBlocks) return {};
  const Index rows = count / 2, cols = count - rows + 1;
  Eigen::MatrixXcd hankel(rows, cols);
  for (Index i = 0; i < rows; ++i) hankel.row(i) = blocks.z.segment(i, cols).transpose();
  const Eigen::MatrixXcd u = hermitian_eigen(hankel * hankel.adjoint()).vectors.rightCols(2);
  // Total least squares: [U up, U down] = W S V', Q = -V12 V22^-1.
  Eigen::MatrixXcd both(rows - 1, 4);
  both << u.topRows(rows - 1), u.bottomRows(rows - 1);
  const Eigen::MatrixXcd v = hermitian_eigen(both.adjoint() * both).vectors;
  const Eigen::Matrix2cd v12 = v.topLeftCorner(2, 2), v22 = v.bottomLeftCorner(2, 2);
  if (!(std::abs(v22.determinant()) > 1e-12)) return {};
  const Eigen::Matrix2cd q = -v12 * v22.inverse();
  const Complex middle = 0.5 * q.trace(), half = std::sqrt(middle * middle - q.determinant());
  std::vector<Complex> poles;
  for (const Complex value : {middle - half, middle + half}) {
    if (!(std::abs(value) > 1e-6)) return {};
    const Complex p =
        std::log(value) / static_cast<double>(blocks.length) + Complex(0, pole.imag());
    if (!(p.imag() > 0)) return {};
    poles.push_back({std::min(p.real(), -1e-3 / static_cast<double>(y.size())), p.imag()});
  }
  return poles;
}

}  // namespace rigfit::signal
