#include "signal/variation/hit_jackknife.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "signal/numerics/numbers.h"
#include "signal/refinement/modal_covariance.h"

namespace rigfit::signal {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// FRFs of the hits on one point, on the band's lines; zero in the columns of other points.
struct HitsOnPoint {
  std::vector<MatrixXcd> H;
  VectorXd weight;  ///< sums to 1
};

HitsOnPoint hits_on(const FrfSet& frfs, const ModalBand& band, std::size_t input) {
  const std::size_t inputs = frfs.inputs.size();
  HitsOnPoint all;
  std::vector<double> weight;
  const bool sized = input < frfs.hit_impulse.size();
  for (std::size_t h = 0; h < frfs.by_hit.size(); ++h) {
    const MatrixXcd H = frfs.by_hit[h](band.rows, Eigen::all);
    MatrixXcd one = MatrixXcd::Zero(H.rows(), H.cols());
    for (auto c = static_cast<Index>(input); c < H.cols(); c += static_cast<Index>(inputs)) {
      one.col(c) = H.col(c);
    }
    if (!one.allFinite()) continue;
    const bool known = sized && h < frfs.hit_impulse[input].size();
    weight.push_back(known ? std::pow(frfs.hit_impulse[input][h], 2) : 0);
    all.H.push_back(std::move(one));
  }
  all.weight = Eigen::Map<const VectorXd>(weight.data(), static_cast<Index>(weight.size()));
  if (weight.empty()) return all;
  if (!(all.weight.minCoeff() > 0) || !all.weight.allFinite()) all.weight.setOnes();
  all.weight /= all.weight.sum();
  return all;
}

/// Variance of the weighted mean of each row, by leaving out one column at a time.
VectorXd jackknife_variance(const MatrixXd& values, const VectorXd& weight) {
  const VectorXd mean = values * weight;
  const Eigen::RowVectorXd rest = (1 - weight.array()).inverse().matrix().transpose();
  const MatrixXd left =
      (mean.rowwise().replicate(values.cols()) - values * weight.asDiagonal()) * rest.asDiagonal();
  const auto n = static_cast<double>(values.cols());
  return (n - 1) / n * (left.colwise() - left.rowwise().mean()).rowwise().squaredNorm();
}

}  // namespace

std::vector<JackknifeOfHits> jackknife_of_hits(const FrfSet& frfs, const ModalBand& band,
                                               const FrfNoise& noise,
                                               const ModalRefineResult& fit) {
  if (frfs.by_hit.size() < 2 || frfs.by_hit.front().rows() <= band.rows.back()) return {};
  const Index modes = fit.poles.size();
  VectorXd frequency = VectorXd::Zero(modes), damping = frequency, squares = frequency;
  for (std::size_t i = 0; i < frfs.inputs.size(); ++i) {
    HitsOnPoint hits = hits_on(frfs, band, i);
    if (hits.H.size() < 2) continue;
    MatrixXcd mean = MatrixXcd::Zero(hits.H.front().rows(), hits.H.front().cols());
    for (std::size_t h = 0; h < hits.H.size(); ++h) {
      mean += hits.weight[static_cast<Index>(h)] * hits.H[h];
    }
    for (MatrixXcd& H : hits.H) H -= mean;
    const MatrixXd errors = pole_errors(band.lines, noise, fit, hits.H);
    if (errors.size() == 0) return {};
    MatrixXd f(modes, errors.cols()), zeta(modes, errors.cols());
    for (Index r = 0; r < modes; ++r) {
      // f = |p| / 2 pi, zeta = -Re p / |p|.
      const double x = fit.poles[r].real(), y = fit.poles[r].imag(), w = std::abs(fit.poles[r]);
      const auto re = errors.row(2 * r), im = errors.row(2 * r + 1);
      f.row(r) = (x * re + y * im) / (w * kTwoPi);
      zeta.row(r) = (x * im - y * re) * (y / (w * w * w));
    }
    const VectorXd variance = jackknife_variance(f, hits.weight);
    frequency += variance;
    damping += jackknife_variance(zeta, hits.weight);
    squares += variance.cwiseAbs2() / static_cast<double>(hits.H.size() - 1);
  }
  std::vector<Index> order(static_cast<std::size_t>(modes));
  for (Index r = 0; r < modes; ++r) order[static_cast<std::size_t>(r)] = r;
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return std::abs(fit.poles[a]) < std::abs(fit.poles[b]); });
  std::vector<JackknifeOfHits> result;
  for (const Index r : order) {
    if (!(squares[r] > 0)) return {};
    result.push_back({std::sqrt(frequency[r]), std::sqrt(damping[r]),
                      frequency[r] * frequency[r] / squares[r]});  // Satterthwaite
  }
  return result;
}

}  // namespace rigfit::signal
