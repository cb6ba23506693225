#include "signal/refinement/modal_refine.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <stdexcept>

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

/// Everything about one set of poles that does not change with the FRF.
struct Stage {
  VectorXcd poles;
  MatrixXd basis, derivatives;  ///< stacked, weighted
  MatrixXd cross;               ///< basis' derivatives
  MatrixXd projected;           ///< Gram of the derivatives outside the basis
  MatrixXd coefficients;        ///< coefficients of the basis, a column an FRF
  MatrixXcd residues;           ///< the modes' part of them
  double cost = 0;
  bool usable = false;
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

  const ScaledGram information(summed_turns(stage.projected, stage.residues, inverse_variance));
  if (!information.usable()) return leverage;
  if (size == 0) return leverage;
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

const char* name_of(RefineEnd end) {
  switch (end) {
    case RefineEnd::converged:
      return "converged";
    case RefineEnd::iteration_limit:
      return "iteration limit";
    case RefineEnd::no_descent:
      return "no descent";
    case RefineEnd::rank_deficient:
      return "rank deficient";
  }
  return "";
}

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
  const double window = lines > 0 ? data.s[0].real() : 0;
  const Index size = 2 * start.size();
  const double freedom =
      std::max(1.0, static_cast<double>((inverse_variance.array() > 0).count()) *
                            static_cast<double>(2 * lines - size - 4 - 2 * data.background.cols()) -
                        static_cast<double>(size));

  ModalRefineResult result;
  Stage stage = stage_at(data, weight, y, y_squared, inverse_variance, start);
  if (!stage.usable) result.end = RefineEnd::rank_deficient;
  while (stage.usable && size > 0 && result.iterations < options.max_iterations) {
    ++result.iterations;
    // basis' residual = 0, so the gradient is derivatives' residual.
    const MatrixXd gradient_all =
        stage.derivatives.transpose() * y - stage.cross.transpose() * stage.coefficients;
    const VectorXcd scores = stage.residues.conjugate().cwiseProduct(from_pairs(gradient_all)) *
                             inverse_variance.cast<Complex>();
    const MatrixXd information = summed_turns(stage.projected, stage.residues, inverse_variance);
    const ScaledGram factor(information);
    if (!factor.usable()) {
      result.end = RefineEnd::rank_deficient;
      break;
    }
    VectorXd step = factor.solve_vector(
        Eigen::Map<const VectorXd>(reinterpret_cast<const double*>(scores.data()), size));
    const double variance = std::max(stage.cost / freedom, 1e-300);
    // In standard deviations of the poles, whatever the scale of the noise given.
    const double length = std::sqrt(std::max(0.0, step.dot(information * step)) / variance);
    double share = 1;
    for (Index r = 0; r < start.size(); ++r) {
      // A pole moves at most half its half bandwidth at once: the linearisation holds that far.
      const double room = 0.5 * std::abs(stage.poles[r].real() - window);
      share = std::min(share, room / std::max(step.segment(2 * r, 2).norm(), 1e-300));
    }
    Stage next;
    bool better = false;
    for (int halving = 0; halving < 8 && !better; ++halving, share *= 0.5) {
      VectorXcd poles = stage.poles;
      for (Index r = 0; r < start.size(); ++r) {
        poles[r] += share * Complex(step[2 * r], step[2 * r + 1]);
      }
      next = stage_at(data, weight, y, y_squared, inverse_variance, poles);
      better = next.usable && next.cost <= stage.cost;
    }
    const bool small = length < options.step_tolerance * std::sqrt(static_cast<double>(size));
    if (better) {
      // A whole step that changed nothing beyond rounding has arrived too (data without noise).
      const bool still = stage.cost - next.cost <= 1e-12 * stage.cost;
      stage = std::move(next);
      if (small || still) {
        result.end = RefineEnd::converged;
        break;
      }
    } else {
      double relative = 0;
      for (Index r = 0; r < start.size(); ++r) {
        relative = std::max(relative, step.segment(2 * r, 2).norm() / std::abs(stage.poles[r]));
      }
      // A cost is what the columns leave of |y|^2, known to its rounding
      // (that of a sum grows with the root of its terms): data without noise are
      // fitted where nothing more is left.
      const double rounding = std::sqrt(static_cast<double>(y.rows())) *
                              std::numeric_limits<double>::epsilon() *
                              (inverse_variance.array() * y_squared.array()).sum();
      result.end = small || relative < 1e-9 || stage.cost <= rounding ? RefineEnd::converged
                                                                      : RefineEnd::no_descent;
      break;
    }
  }
  result.poles = stage.poles;
  if (!stage.usable) return result;
  if (size == 0) result.end = RefineEnd::converged;
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
