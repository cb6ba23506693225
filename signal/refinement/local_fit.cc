#include "signal/refinement/local_fit.h"

#include <cmath>
#include <complex>
#include <stdexcept>
#include <utility>

#include "signal/numerics/factorisations.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// Everything at one set of free poles.
struct State {
  VectorXcd poles;
  MatrixXcd orthonormal;  ///< orthonormal basis of the model's columns
  MatrixXcd coefficients;
  MatrixXcd residual;
  double cost = 0;
  bool usable = false;
};

MatrixXcd columns_of(const VectorXcd& s, const VectorXcd& poles, const VectorXcd& fixed,
                     int order) {
  const Index lines = s.size(), free = poles.size(), all = free + fixed.size();
  MatrixXcd basis(lines, all + order + 1);
  for (Index r = 0; r < all; ++r) {
    const Complex p = r < free ? poles[r] : fixed[r - free];
    basis.col(r) = (s.array() - p).inverse();
  }
  const double low = s[0].imag(), high = s[lines - 1].imag();
  const VectorXd x = (2 * s.imag().array() - low - high) / (high - low);
  basis.col(all).setOnes();
  for (int j = 1; j <= order; ++j) {
    basis.col(all + j) = basis.col(all + j - 1).cwiseProduct(x.cast<Complex>());
  }
  return basis;
}

State state_at(const VectorXcd& s, const MatrixXcd& H, const VectorXd& weight, VectorXcd poles,
               const VectorXcd& fixed, int order) {
  State state;
  state.poles = std::move(poles);
  MatrixXcd basis = columns_of(s, state.poles, fixed, order);
  const VectorXd length = basis.colwise().norm().transpose();
  for (Index j = 0; j < basis.cols(); ++j) basis.col(j) /= length[j];
  ThinQr<MatrixXcd> qr = thin_qr(basis);
  if (!(qr.R.diagonal().cwiseAbs().minCoeff() > 1e-10)) return state;
  state.orthonormal = std::move(qr.Q);
  const MatrixXcd moments = state.orthonormal.adjoint() * H;
  state.residual = H - state.orthonormal * moments;
  state.coefficients = qr.R.triangularView<Eigen::Upper>().solve(moments);
  for (Index j = 0; j < basis.cols(); ++j) state.coefficients.row(j) /= length[j];
  state.cost = state.residual.colwise().squaredNorm().transpose().dot(weight);
  state.usable = std::isfinite(state.cost);
  return state;
}

/// Derivatives of the free poles' columns outside the model's columns.
MatrixXcd outside_derivatives(const VectorXcd& s, const State& state) {
  MatrixXcd D(s.size(), state.poles.size());
  for (Index r = 0; r < D.cols(); ++r) {
    D.col(r) = (s.array() - state.poles[r]).square().inverse();
  }
  D -= state.orthonormal * (state.orthonormal.adjoint() * D);
  return D;
}

/// sum_c w_c conj(a_rc) a_qc (D_r' D_q): what the columns tell about the poles.
MatrixXcd information(const MatrixXcd& D, const MatrixXcd& amplitudes, const VectorXd& weight) {
  const MatrixXcd across = amplitudes.conjugate() * weight.asDiagonal() * amplitudes.transpose();
  return (D.adjoint() * D).cwiseProduct(across);
}

/// The longest share of a step that keeps poles stable and within the window.
double room_of(const VectorXcd& s, const VectorXcd& poles, const VectorXcd& step) {
  const double window = s[0].real(), low = s[0].imag(), high = s[s.size() - 1].imag();
  double share = 1;
  for (Index r = 0; r < poles.size(); ++r) {
    const double half = window - poles[r].real();
    share = std::min(share, half / std::max(std::abs(step[r]), 1e-300));
    if (step[r].real() > 0) share = std::min(share, 0.7 * half / step[r].real());
    const double to_end = step[r].imag() > 0 ? high - poles[r].imag() : poles[r].imag() - low;
    share = std::min(share, std::max(0.0, to_end) / std::max(std::abs(step[r].imag()), 1e-300));
  }
  return share;
}

}  // namespace

LocalFit fit_locally(const Eigen::Ref<const VectorXcd>& s, const Eigen::Ref<const MatrixXcd>& H,
                     const Eigen::Ref<const VectorXd>& weight,
                     const Eigen::Ref<const VectorXcd>& start,
                     const Eigen::Ref<const VectorXcd>& fixed, int order) {
  if (H.rows() != s.size() || weight.size() != H.cols()) {
    throw std::invalid_argument("fit_locally: sizes do not fit");
  }
  LocalFit fit;
  const Index free = start.size();
  fit.freedom = s.size() - free - fixed.size() - order - 1;
  if (fit.freedom < 2 || free == 0) return fit;
  const auto at = [&](VectorXcd poles) {
    return state_at(s, H, weight, std::move(poles), fixed, order);
  };
  State state = at(start);
  if (!state.usable) return fit;
  for (int iteration = 0; iteration < 30; ++iteration) {
    const MatrixXcd D = outside_derivatives(s, state);
    const MatrixXcd amplitudes = state.coefficients.topRows(free);
    const MatrixXcd scores = D.adjoint() * state.residual;
    const VectorXcd gradient =
        (amplitudes.conjugate().cwiseProduct(scores)) * weight.cast<Complex>();
    const VectorXcd step =
        hermitian_eigen(information(D, amplitudes, weight)).pseudo_inverse() * gradient;
    if (!step.allFinite()) break;
    double share = room_of(s, state.poles, step);
    State next;
    bool better = false;
    for (int halving = 0; halving < 8 && !better; ++halving, share *= 0.5) {
      next = at(state.poles + share * step);
      better = next.usable && next.cost <= state.cost;
    }
    if (!better) break;
    const double gained = state.cost - next.cost;
    state = std::move(next);
    if (gained <= 1e-9 * state.cost) break;
  }
  fit.poles = state.poles;
  fit.amplitudes = state.coefficients.topRows(free);
  fit.residual = state.residual;
  fit.misfit = state.residual.colwise().squaredNorm().transpose();
  const MatrixXcd D = outside_derivatives(s, state);
  const MatrixXcd curvature = information(D, fit.amplitudes, weight);
  fit.covariance = hermitian_eigen(curvature).pseudo_inverse();
  // |a|^2 over its unit variance: what a column of the model adds to the fit.
  const MatrixXcd basis = columns_of(s, state.poles, fixed, order);
  const MatrixXcd inverse = hermitian_eigen(basis.adjoint() * basis).pseudo_inverse();
  fit.gain.resize(free, H.cols());
  for (Index r = 0; r < free; ++r) {
    fit.gain.row(r) = fit.amplitudes.row(r).cwiseAbs2() / std::max(inverse(r, r).real(), 1e-300);
  }
  fit.usable = fit.covariance.allFinite();
  return fit;
}

}  // namespace rigfit::signal
