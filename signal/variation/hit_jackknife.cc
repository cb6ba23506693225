#include "signal/variation/hit_jackknife.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "signal/numerics/numbers.h"
#include "signal/refinement/modal_covariance.h"

namespace rigfit::signal {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// Frequencies, then damping ratios, that every hit on one point would have changed those of the
/// average by, if all hits on it had been like this: a column each.
struct HitsOnPoint {
  MatrixXd change;
  VectorXd weight;  ///< sums to 1
};

/// Weights of the hits on a point: their squared impulses, where known.
VectorXd weights_of(const FrfSet& frfs, std::size_t input, const std::vector<std::size_t>& hits) {
  VectorXd weight = VectorXd::Zero(static_cast<Index>(hits.size()));
  for (std::size_t k = 0; k < hits.size() && input < frfs.hit_impulse.size(); ++k) {
    const std::vector<double>& impulse = frfs.hit_impulse[input];
    if (hits[k] < impulse.size()) weight[static_cast<Index>(k)] = std::pow(impulse[hits[k]], 2);
  }
  if (!weight.allFinite() || !(weight.minCoeff() > 0)) weight.setOnes();
  return weight / weight.sum();
}

/// Changes of frequencies, then damping ratios, by those of poles (Re, Im of each): by columns.
MatrixXd as_frequency_and_damping(const VectorXcd& poles, const MatrixXd& moved) {
  const Index modes = poles.size();
  MatrixXd result(2 * modes, moved.cols());
  for (Index r = 0; r < modes; ++r) {
    // f = |p| / 2 pi, zeta = -Re p / |p|.
    const double x = poles[r].real(), y = poles[r].imag(), w = std::abs(poles[r]);
    const auto re = moved.row(2 * r), im = moved.row(2 * r + 1);
    result.row(r) = (x * re + y * im) / (w * kTwoPi);
    result.row(modes + r) = (x * im - y * re) * (y / (w * w * w));
  }
  return result;
}

/// By input; empty where the poles cannot be told apart.
std::vector<HitsOnPoint> changes_by_hits(const FrfSet& frfs, const ModalBand& band,
                                         const FrfNoise& noise, const ModalRefineResult& fit) {
  const auto inputs = static_cast<Index>(frfs.inputs.size());
  const Index frfs_each = frfs.H.cols() / inputs;
  // By hit: parts of the poles x inputs; NaN where a point has fewer hits.
  std::vector<MatrixXd> moved;
  for (const MatrixXcd& by_hit : frfs.by_hit) {
    MatrixXcd error = by_hit(band.rows, Eigen::all);
    MatrixXd sum = MatrixXd::Zero(2 * fit.poles.size(), inputs);
    for (Index c = 0; c < error.cols(); ++c) {
      if (error.col(c).allFinite()) continue;
      sum.col(c % inputs).setConstant(kNaN);
      error.col(c).setZero();
    }
    const MatrixXd parts = pole_errors(band.lines, noise, fit, error - band.lines.H);
    if (parts.size() == 0) return {};
    for (Index o = 0; o < frfs_each; ++o) sum += parts.middleCols(o * inputs, inputs);
    moved.push_back(std::move(sum));
  }
  std::vector<HitsOnPoint> all(frfs.inputs.size());
  for (Index i = 0; i < inputs; ++i) {
    std::vector<std::size_t> hits;
    for (std::size_t h = 0; h < moved.size(); ++h) {
      if (moved[h].col(i).allFinite()) hits.push_back(h);
    }
    MatrixXd poles(2 * fit.poles.size(), static_cast<Index>(hits.size()));
    for (std::size_t k = 0; k < hits.size(); ++k) {
      poles.col(static_cast<Index>(k)) = moved[hits[k]].col(i);
    }
    auto& point = all[static_cast<std::size_t>(i)];
    point.change = as_frequency_and_damping(fit.poles, poles);
    if (!hits.empty()) point.weight = weights_of(frfs, static_cast<std::size_t>(i), hits);
  }
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
  VectorXd variance = VectorXd::Zero(2 * modes), squares = variance;
  for (const HitsOnPoint& point : changes_by_hits(frfs, band, noise, fit)) {
    if (point.change.cols() < 2) continue;
    const VectorXd one = jackknife_variance(point.change, point.weight);
    variance += one;
    squares += one.cwiseAbs2() / static_cast<double>(point.change.cols() - 1);
  }
  std::vector<Index> order(static_cast<std::size_t>(modes));
  for (Index r = 0; r < modes; ++r) order[static_cast<std::size_t>(r)] = r;
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return std::abs(fit.poles[a]) < std::abs(fit.poles[b]); });
  std::vector<JackknifeOfHits> result;
  for (const Index r : order) {
    if (!(squares[r] > 0)) return {};
    result.push_back({std::sqrt(variance[r]), std::sqrt(variance[modes + r]),
                      variance[r] * variance[r] / squares[r]});  // Satterthwaite
  }
  return result;
}

}  // namespace rigfit::signal
