#include "signal/modal/pole_fit.h"

#include <gsl/gsl_cdf.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "signal/estimation/robust.h"
#include "signal/numerics/factorisations.h"
#include "signal/numerics/numbers.h"

namespace rigfit::signal {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

namespace {

/// Half bandwidths to either side of a pole. A quadratic background raises a pole's standard
/// deviation by 1.23 over that in an infinite window (1.36 for 10, 1.11 for 30).
constexpr double kReach = 15;
constexpr Index kLeastLines = 12;  // 25 lines leave 20 degrees of freedom for an FRF's weight
constexpr Index kDegree = 2;       // of the background
/// Widths beside a window in which modes are held: further ones leave less than 4 % of the
/// quadratic's third order.
constexpr double kBeside = 1.5;
constexpr double kOverlap = 2;  // sums of half bandwidths

void project(const MatrixXcd& Q, MatrixXcd& X) { X.noalias() -= Q * (Q.adjoint() * X).eval(); }

/// Gram matrices and what follows of them at given poles; steps are counted in lines.
PoleFit evaluate(const PoleWindow& window, const Eigen::Ref<const MatrixXcd>& Y,
                 const VectorXd& total, const VectorXd& weights, const VectorXcd& poles,
                 double step) {
  const Index m = poles.size(), lines = window.s.size();
  MatrixXcd X(lines, 2 * m);
  for (Index r = 0; r < m; ++r) {
    X.col(r) = (window.s.array() - poles[r]).inverse() * step;
    X.col(m + r) = X.col(r).array().square();
  }
  project(window.Q, X);
  MatrixXcd A = X.adjoint() * X;
  const MatrixXcd B = X.adjoint() * Y;
  A.topLeftCorner(m, m).diagonal().array() += 1e-12 * A.topLeftCorner(m, m).trace().real();
  const Eigen::LLT<MatrixXcd> factor(A.topLeftCorner(m, m));
  PoleFit fit;
  fit.poles = poles;
  fit.weights = weights;
  fit.residues = factor.solve(B.topRows(m));
  fit.turn = factor.solve(A.topRightCorner(m, m));
  fit.gram_inverse = factor.solve(MatrixXcd::Identity(m, m));
  fit.schur = A.bottomRightCorner(m, m) - A.bottomLeftCorner(m, m) * fit.turn;
  const MatrixXcd weighted = fit.residues.conjugate() * weights.asDiagonal();
  fit.normal = fit.schur.cwiseProduct(weighted * fit.residues.transpose());
  fit.pull = weighted.cwiseProduct(B.bottomRows(m) - A.bottomLeftCorner(m, m) * fit.residues);
  fit.squares =
      (total -
       B.topRows(m).conjugate().cwiseProduct(fit.residues).real().colwise().sum().transpose())
          .cwiseMax(1e-14 * total);
  return fit;
}

VectorXd weights_of(const VectorXd& squares, double freedom) {
  const VectorXd v = squares / freedom;
  const double least = 1e-8 * median({v.begin(), v.end()}) + 1e-300;
  return v.cwiseMax(least).cwiseInverse();
}

double half_bandwidth(const ModalData& data, Complex pole) {
  return (data.window - pole.real()) / kTwoPi;
}

}  // namespace

PoleFit fit_poles(const PoleWindow& window, Index first, const VectorXd& weights,
                  const VectorXcd& start, int steps) {
  const auto Y = window.Y.middleCols(first, weights.size());
  const VectorXd total = Y.colwise().squaredNorm().transpose();
  const double step = std::abs(window.s[1] - window.s[0]);
  const double window_rate = window.s[0].real();
  const double low = window.s[0].imag(), high = window.s[window.s.size() - 1].imag();
  PoleFit fit = evaluate(window, Y, total, weights, start, step);
  double damping = 1e-3, error = weights.dot(fit.squares);
  for (int k = 0; k < steps && damping < 1e6; ++k) {
    MatrixXcd M = fit.normal;
    for (Index r = 0; r < M.rows(); ++r) {
      const double d = M(r, r).real();
      M(r, r) += d > 0 ? damping * d : 1.0;
    }
    const VectorXcd move = M.llt().solve(fit.pull.rowwise().sum()) * step;
    VectorXcd poles = fit.poles;
    double change = 0;
    for (Index r = 0; r < poles.size(); ++r) {
      const double half = std::max(window_rate - poles[r].real(), step);
      const double size = std::abs(move[r]);
      if (!(size < std::numeric_limits<double>::infinity())) continue;
      Complex next = poles[r] + move[r] * std::min(1.0, half / std::max(size, 1e-300));
      next = {std::min(next.real(), window_rate - 2e-3 * step), std::clamp(next.imag(), low, high)};
      change = std::max(change, std::abs(next - poles[r]) / half);
      poles[r] = next;
    }
    PoleFit next = evaluate(window, Y, total, weights, poles, step);
    const double left = weights.dot(next.squares);
    if (left <= error) {
      fit = std::move(next), error = left, damping /= 5;
      if (change < 1e-5) break;
    } else {
      damping *= 8;
    }
  }
  // From steps in lines to rad/s.
  fit.residues *= step;
  fit.gram_inverse *= step * step;
  fit.turn /= step;
  fit.normal /= step * step;
  fit.schur /= std::pow(step, 4);
  fit.pull /= step;
  return fit;
}

PoleFit fit_common_poles(const PoleWindow& window, const VectorXcd& poles) {
  const auto columns = static_cast<double>(window.Y.cols());
  const double freedom = std::max(1.0, static_cast<double>(window.s.size() - window.Q.cols()) -
                                           static_cast<double>(poles.size()) * (1 + 0.5 / columns));
  VectorXd weights = VectorXd::Ones(window.Y.cols());
  PoleFit fit = fit_poles(window, 0, weights, poles, 0);
  for (int k = 0; k < 2; ++k) {
    weights = weights_of(fit.squares, freedom);
    fit = fit_poles(window, 0, weights, fit.poles, 20);
  }
  weights = weights_of(fit.squares, freedom);
  fit = fit_poles(window, 0, weights, fit.poles, 0);
  fit.freedom = freedom;
  return fit;
}

MatrixXcd resonances(const PoleWindow& window, const VectorXcd& poles) {
  MatrixXcd X(window.s.size(), poles.size());
  for (Index r = 0; r < poles.size(); ++r) X.col(r) = (window.s.array() - poles[r]).inverse();
  project(window.Q, X);
  return X;
}

PoleWindow with_held(const PoleWindow& window, const VectorXcd& poles) {
  if (poles.size() == 0) return window;
  PoleWindow held = window;
  const MatrixXcd more = thin_qr(resonances(window, poles)).Q;
  project(more, held.Y);
  held.Q.resize(window.Q.rows(), window.Q.cols() + more.cols());
  held.Q << window.Q, more;
  return held;
}

namespace {

/// Correlation of neighbouring lines applied to columns.
MatrixXcd correlated(const ModalData& data, const MatrixXcd& X) {
  const Index n = X.rows();
  // Beyond so many lines |rho| is below 1 %.
  const Index far = std::min(n, static_cast<Index>(32 * data.correlation_lines) + 1);
  MatrixXcd result = X;
  for (Index d = 1; d < far; ++d) {
    const Complex rho = data.line_correlation(d);
    result.bottomRows(n - d) += rho * X.topRows(n - d);
    result.topRows(n - d) += std::conj(rho) * X.bottomRows(n - d);
  }
  return result;
}

}  // namespace

MatrixXcd pole_covariance(const ModalData& data, const PoleWindow& window, const PoleFit& fit) {
  const Index m = fit.poles.size();
  const MatrixXcd inverse = fit.normal.llt().solve(MatrixXcd::Identity(m, m));
  if (!(data.correlation_lines > 0)) return inverse;
  // Sandwich with the derivative's part outside of background and resonances.
  const MatrixXcd X = resonances(window, fit.poles);
  MatrixXcd D(window.s.size(), m);
  for (Index r = 0; r < m; ++r) {
    D.col(r) = (window.s.array() - fit.poles[r]).inverse().square();
  }
  project(window.Q, D);
  D -= X * (X.adjoint() * X).llt().solve(X.adjoint() * D);
  const MatrixXcd middle = (D.adjoint() * correlated(data, D))
                               .cwiseProduct(fit.residues.conjugate() * fit.weights.asDiagonal() *
                                             fit.residues.transpose());
  return inverse * middle * inverse;
}

CorrelatedNoise correlated_noise(const ModalData& data, const PoleWindow& window, Complex pole) {
  if (!(data.correlation_lines > 0)) return {};
  const MatrixXcd X = resonances(window, VectorXcd::Constant(1, pole));
  MatrixXcd D = (window.s.array() - pole).inverse().square().matrix();
  project(window.Q, D);
  D -= X * (X.adjoint() * D) / X.squaredNorm();
  return {(X.adjoint() * correlated(data, X))(0, 0).real() / X.squaredNorm(),
          (D.adjoint() * correlated(data, D))(0, 0).real() / D.squaredNorm()};
}

VectorXd gains(const ModalData& data, const PoleWindow& window, const PoleFit& fit) {
  const Index m = fit.poles.size();
  const VectorXd power = fit.residues.cwiseAbs2() * fit.weights;
  VectorXd F = power.array() / fit.gram_inverse.diagonal().real().array() /
               static_cast<double>(fit.residues.cols() + 1);
  if (data.correlation_lines > 0) {
    // What noise of correlated lines gives the part of a resonance outside of all else.
    const MatrixXcd own = resonances(window, fit.poles) * fit.gram_inverse;
    const MatrixXcd spread = correlated(data, own);
    for (Index r = 0; r < m; ++r) {
      F[r] /= std::max(1.0, own.col(r).dot(spread.col(r)).real() / own.col(r).squaredNorm());
    }
  }
  return F;
}

std::vector<std::vector<Index>> blocks_of(const ModalData& data, const VectorXcd& poles) {
  std::vector<Index> order(static_cast<std::size_t>(poles.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return poles[a].imag() < poles[b].imag(); });
  std::vector<std::vector<Index>> blocks;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool joins = i > 0 && poles[order[i]].imag() - poles[order[i - 1]].imag() <
                                    kTwoPi * kOverlap *
                                        (half_bandwidth(data, poles[order[i]]) +
                                         half_bandwidth(data, poles[order[i - 1]]));
    if (!joins) blocks.emplace_back();
    blocks.back().push_back(order[i]);
  }
  return blocks;
}

MatrixXcd smooth_basis(Index lines) {
  MatrixXd P(lines, kDegree + 1);
  const Eigen::ArrayXd x = Eigen::ArrayXd::LinSpaced(lines, -1, 1);
  for (Index j = 0; j <= kDegree; ++j) P.col(j) = x.pow(static_cast<double>(j));
  return thin_qr(P).Q.cast<Complex>();
}

PoleWindow window_of(const ModalData& data, const Eigen::Ref<const MatrixXcd>& Y,
                     const VectorXcd& poles, const std::vector<Index>& block) {
  const VectorXd& f = data.frequency_hz;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Index r : block) {
    const double at = poles[r].imag() / kTwoPi;
    const double reach = std::max(kReach * half_bandwidth(data, poles[r]),
                                  static_cast<double>(kLeastLines) * data.spacing_hz);
    low = std::min(low, at - reach), high = std::max(high, at + reach);
  }
  // Near an end of the lines the window is one-sided, as long as elsewhere as far as they go.
  if (low < f[0]) high += f[0] - low;
  if (high > f[f.size() - 1]) low -= high - f[f.size() - 1];
  PoleWindow window;
  window.first = std::lower_bound(f.begin(), f.end(), low) - f.begin();
  const Index last = std::upper_bound(f.begin(), f.end(), high) - f.begin();
  const Index lines = std::max<Index>(0, last - window.first);
  window.s = data.s.segment(window.first, lines);
  if (lines < 2) return window;
  const double from = window.s[0].imag(), to = window.s[lines - 1].imag(), wide = to - from;
  std::vector<std::pair<double, Index>> beside;
  for (Index h = 0; h < poles.size(); ++h) {
    if (std::find(block.begin(), block.end(), h) != block.end()) continue;
    const double at = poles[h].imag();
    if (at < from - kBeside * wide || at > to + kBeside * wide) continue;
    const double away = std::max({0.0, from - at, at - to});
    beside.emplace_back(std::hypot(away, data.window - poles[h].real()), h);
  }
  std::sort(beside.begin(), beside.end());
  const Index room = std::max<Index>(0, lines / 3 - kDegree - static_cast<Index>(block.size()));
  beside.resize(std::min(beside.size(), static_cast<std::size_t>(room)));
  MatrixXcd B(lines, kDegree + 1 + static_cast<Index>(beside.size()));
  B.leftCols(kDegree + 1) = smooth_basis(lines);
  for (std::size_t i = 0; i < beside.size(); ++i) {
    B.col(kDegree + 1 + static_cast<Index>(i)) =
        (window.s.array() - poles[beside[i].second]).inverse().matrix().normalized();
  }
  window.Q = thin_qr(B).Q;
  window.Y = Y.middleRows(window.first, lines);
  project(window.Q, window.Y);
  return window;
}

double chance_of(double F, double numerator, double denominator) {
  if (!(F > 0)) return 1;
  return gsl_cdf_fdist_Q(F, numerator, denominator);
}

}  // namespace rigfit::signal
