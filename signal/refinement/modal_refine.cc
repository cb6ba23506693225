#include "signal/refinement/modal_refine.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <stdexcept>

#include "signal/numerics/numbers.h"
#include "signal/numerics/scaled_gram.h"
#include "signal/refinement/modal_basis.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// The fit at one set of poles.
struct Stage : PoleStage {
  MatrixXd basis, derivatives;  ///< stacked, weighted
  MatrixXd cross;               ///< basis' derivatives
  MatrixXd projected;           ///< Gram of the derivatives outside the basis
  MatrixXd coefficients;        ///< coefficients of the basis, a column an FRF
  MatrixXcd residues;           ///< the modes' part of them
};

Stage stage_at(const FrfLines& data, const VectorXd& weight, const MatrixXd& y,
               const VectorXd& y_squared, const VectorXd& inverse_variance,
               const VectorXcd& poles) {
  Stage stage;
  stage.poles = poles;
  stage.basis = weighted_basis(data, poles, weight);
  const ScaledGram factor(gram_of(stage.basis));
  if (!factor.usable()) return stage;
  const MatrixXd moments = stage.basis.transpose() * y;
  stage.coefficients = factor.solve(moments);
  stage.residues = from_pairs(stage.coefficients.topRows(2 * poles.size()));
  stage.cost = (y_squared - moments.cwiseProduct(stage.coefficients).colwise().sum().transpose())
                   .cwiseMax(0)
                   .dot(inverse_variance);
  stage.derivatives = stacked_pole_derivatives(data.s, data.power, poles, weight);
  stage.cross.noalias() = stage.basis.transpose() * stage.derivatives;
  stage.projected =
      gram_of(stage.derivatives) - stage.cross.transpose() * factor.solve(stage.cross);
  stage.information = summed_turns(stage.projected, stage.residues, inverse_variance);
  // basis' residual = 0, so the gradient is derivatives' residual.
  const MatrixXd products =
      stage.derivatives.transpose() * y - stage.cross.transpose() * stage.coefficients;
  const VectorXcd scores = stage.residues.conjugate().cwiseProduct(from_pairs(products)) *
                           inverse_variance.cast<Complex>();
  stage.gradient =
      Eigen::Map<const VectorXd>(reinterpret_cast<const double*>(scores.data()), 2 * scores.size());
  stage.usable = std::isfinite(stage.cost);
  return stage;
}

/// Share of the freedom of each line that the fit uses, mean over FRFs.
VectorXd leverage_of(const Stage& stage, const FrfNoise& noise, const VectorXd& inverse_variance) {
  const Index lines = stage.basis.rows() / 2, size = stage.projected.rows();
  const ScaledGram factor(gram_of(stage.basis));
  const MatrixXd U = factor.orthonormal(stage.basis);
  const MatrixXd rho_U = correlated(noise, U);
  // 1 - diag((I - UU') rho (I - UU')).
  const VectorXd both = 2 * U.cwiseProduct(rho_U).rowwise().sum() -
                        (U * (U.transpose() * rho_U)).cwiseProduct(U).rowwise().sum();
  VectorXd leverage = 0.5 * (both.head(lines) + both.tail(lines));

  const ScaledGram information(stage.information);
  if (!information.usable() || size == 0) return leverage;
  const MatrixXd outside = stage.derivatives - stage.basis * factor.solve(stage.cross);
  // T covariance T' is the turn T' of the conjugate residues.
  const MatrixXd turned_sum =
      summed_turns(information.inverse(), stage.residues.conjugate(), inverse_variance);
  const VectorXd poles = (outside * turned_sum).cwiseProduct(outside).rowwise().sum();
  const double frfs =
      static_cast<double>(std::max<Index>(1, (inverse_variance.array() > 0).count()));
  return leverage + 0.5 * (poles.head(lines) + poles.tail(lines)) / frfs;
}

}  // namespace

MatrixXd weighted_basis(const FrfLines& data, const Eigen::Ref<const VectorXcd>& poles,
                        const Eigen::Ref<const VectorXd>& line_weight) {
  MatrixXd basis = stacked_basis(data.s, data.power, poles, line_weight);
  const Index first = basis.cols(), terms = data.background.cols();
  if (terms == 0) return basis;
  basis.conservativeResize(Eigen::NoChange, first + 2 * terms);
  MatrixXcd columns(data.s.size(), 2 * terms);
  for (Index t = 0; t < terms; ++t) {
    columns.col(2 * t) = data.background.col(t);
    columns.col(2 * t + 1) = Complex(0, 1) * data.background.col(t);
  }
  basis.rightCols(2 * terms) = stacked(columns, line_weight);
  return basis;
}

MatrixXcd fitted_frfs(const FrfLines& data, const ModalRefineResult& fit) {
  MatrixXcd H = synthesise(data.s, data.power, fit.poles, fit.residues, fit.lower, fit.upper);
  if (fit.background.size() > 0) H += data.background * fit.background;
  return H;
}

ModalRefineResult refine_modes(const FrfLines& data, const FrfNoise& noise,
                               const Eigen::Ref<const VectorXcd>& start,
                               const ModalRefineOptions& options) {
  const Index lines = data.s.size();
  if (data.H.rows() != lines || noise.line.size() != lines ||
      noise.column.size() != data.H.cols()) {
    throw std::invalid_argument("refine_modes: sizes do not fit");
  }
  const VectorXd weight = line_weight(noise, data.H);
  const MatrixXd y = stacked(data.H, weight);
  const VectorXd y_squared = y.colwise().squaredNorm().transpose();
  const VectorXd inverse_variance = inverse_variance_of(noise);
  const Index size = 2 * start.size();
  PoleStepOptions steps;
  steps.max_iterations = options.max_iterations;
  steps.step_in_std = options.step_tolerance;
  steps.freedom =
      std::max(1.0, static_cast<double>((inverse_variance.array() > 0).count()) *
                            static_cast<double>(2 * lines - size - 4 - 2 * data.background.cols()) -
                        static_cast<double>(size));
  // What the columns leave of |y|^2: the rounding of a sum grows with the root of its terms.
  steps.rounding = std::sqrt(static_cast<double>(y.rows())) *
                   std::numeric_limits<double>::epsilon() * inverse_variance.dot(y_squared);
  if (lines > 1) {
    steps.undamped = data.s[0].real();
    // A steady tone on a line would draw its pole towards the axis for ever. A thousandth lost over
    // records as long as lines can tell, 1 / spacing, is as good as nothing.
    const double spacing = (data.s.tail(lines - 1) - data.s.head(lines - 1)).imag().minCoeff();
    steps.slowest = steps.undamped - 1e-3 * spacing / kTwoPi;
  }

  const auto at = [&](const VectorXcd& poles) {
    return stage_at(data, weight, y, y_squared, inverse_variance, poles);
  };
  ModalRefineResult result;
  Stage stage = at(start);
  result.end = take_pole_steps(steps, at, stage, &result.iterations);
  result.poles = stage.poles;
  if (!stage.usable) return result;
  const MatrixXcd coefficients = from_pairs(stage.coefficients);
  result.residues = stage.residues;
  result.lower = coefficients.row(start.size());
  result.upper = coefficients.row(start.size() + 1);
  result.background = coefficients.bottomRows(data.background.cols());
  result.cost = stage.cost;
  result.leverage = leverage_of(stage, noise, inverse_variance);
  return result;
}

}  // namespace rigfit::signal
