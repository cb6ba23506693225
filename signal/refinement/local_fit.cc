#include "signal/refinement/local_fit.h"

#include <cmath>
#include <complex>
#include <stdexcept>

#include "signal/estimation/pole_steps.h"
#include "signal/numerics/factorisations.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// The fit at one set of free poles.
struct State : PoleStage {
  MatrixXcd coefficients;  ///< free poles x columns
  MatrixXcd residual;
  MatrixXcd outside;  ///< D: derivatives of the free poles' columns outside the model's
  MatrixXcd analytic_information;  ///< sum_c w_c conj(a_rc) a_qc (D_r' D_q)
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

State state_at(const VectorXcd& s, const MatrixXcd& H, const VectorXd& weight,
               const VectorXcd& poles, const VectorXcd& fixed, int order) {
  State state;
  state.poles = poles;
  MatrixXcd basis = columns_of(s, poles, fixed, order);
  const VectorXd length = basis.colwise().norm().transpose();
  for (Index j = 0; j < basis.cols(); ++j) basis.col(j) /= length[j];
  const ThinQr<MatrixXcd> qr = thin_qr(basis);
  if (!(qr.R.diagonal().cwiseAbs().minCoeff() > 1e-10)) return state;
  const MatrixXcd moments = qr.Q.adjoint() * H;
  const MatrixXcd all = qr.R.triangularView<Eigen::Upper>().solve(moments);
  state.coefficients =
      length.head(poles.size()).cwiseInverse().asDiagonal() * all.topRows(poles.size());
  state.residual = H - qr.Q * moments;
  state.cost = state.residual.colwise().squaredNorm().transpose().dot(weight);
  MatrixXcd& D = state.outside;
  D.resize(s.size(), poles.size());
  for (Index r = 0; r < D.cols(); ++r) D.col(r) = (s.array() - poles[r]).square().inverse();
  D -= qr.Q * (qr.Q.adjoint() * D);
  const MatrixXcd conjugate = state.coefficients.conjugate();
  state.analytic_information =
      (D.adjoint() * D)
          .cwiseProduct(conjugate * weight.asDiagonal() * state.coefficients.transpose());
  state.set_analytic(conjugate.cwiseProduct(D.adjoint() * state.residual) * weight.cast<Complex>(),
                     state.analytic_information);
  state.usable = std::isfinite(state.cost);
  return state;
}

}  // namespace

LocalFit fit_locally(const Eigen::Ref<const VectorXcd>& s, const Eigen::Ref<const MatrixXcd>& H,
                     const Eigen::Ref<const VectorXd>& weight,
                     const Eigen::Ref<const VectorXcd>& start,
                     const Eigen::Ref<const VectorXcd>& fixed, int order, double step_in_std) {
  if (H.rows() != s.size() || weight.size() != H.cols()) {
    throw std::invalid_argument("fit_locally: sizes do not fit");
  }
  LocalFit fit;
  const Index free = start.size();
  fit.freedom = s.size() - free - fixed.size() - order - 1;
  if (fit.freedom < 2 || free == 0) return fit;
  const auto at = [&](const VectorXcd& poles) {
    return state_at(s, H, weight, poles, fixed, order);
  };
  State state = at(start);
  if (!state.usable) return fit;
  PoleStepOptions steps;
  steps.max_iterations = 30;
  steps.step_in_std = step_in_std;
  steps.freedom = static_cast<double>(2 * fit.freedom * H.cols());
  steps.rounding = 1e-28 * H.colwise().squaredNorm().dot(weight);
  steps.undamped = s[0].real();
  steps.low = s[0].imag(), steps.high = s[s.size() - 1].imag();
  take_pole_steps(steps, at, state);
  fit.poles = state.poles;
  fit.amplitudes = state.coefficients;
  fit.residual = state.residual;
  fit.misfit = state.residual.colwise().squaredNorm().transpose();
  fit.covariance = hermitian_eigen(state.analytic_information).pseudo_inverse();
  // Score of each line: sum_c w_c conj(a_rc D_kr) times what is left.
  const MatrixXcd score = state.outside.conjugate().cwiseProduct(
      state.residual * weight.asDiagonal() * fit.amplitudes.adjoint());
  fit.robust_covariance = fit.covariance * (score.transpose() * score.conjugate()) *
                          fit.covariance *
                          (static_cast<double>(s.size()) / static_cast<double>(fit.freedom));
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
