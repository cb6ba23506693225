#include "signal/refinement/modal_refine.h"

#include <Eigen/LU>

#include "signal/numerics/factorisations.h"
#include "signal/refinement/modal_basis.h"

namespace rigfit::signal {
namespace {

/// The fit at one set of poles.
struct Stage : PoleStage {
  MatrixXd coefficients;  ///< the basis has, a column an FRF
  MatrixXcd residues;     ///< the modes' part of them
};

Stage stage_at(const FrfLines& data, const VectorXd& weight, const MatrixXd& y,
               const VectorXd& y_squared, const VectorXd& inverse_variance,
               const VectorXcd& poles) {
  Stage stage;
  stage.poles = poles;
  const MatrixXd basis = stacked_basis(data.s, data.power, poles, weight, data.background);
  const ScaledGram factor(gram_of(basis));
  if (!factor.usable()) return stage;
  const MatrixXd moments = basis.transpose() * y;
  stage.coefficients = factor.solve(moments);
  stage.residues = from_pairs(stage.coefficients.topRows(2 * poles.size()));
  stage.cost = (y_squared - moments.cwiseProduct(stage.coefficients).colwise().sum().transpose())
                   .cwiseMax(0)
                   .dot(inverse_variance);
  const MatrixXd derivatives = stacked_pole_derivatives(data.s, data.power, poles, weight);
  const MatrixXd cross = basis.transpose() * derivatives;
  stage.information = summed_turns(gram_of(derivatives) - cross.transpose() * factor.solve(cross),
                                   stage.residues, inverse_variance);
  // basis' residual = 0, so the gradient is derivatives' residual.
  const MatrixXd products = derivatives.transpose() * y - cross.transpose() * stage.coefficients;
  const VectorXcd scores = stage.residues.conjugate().cwiseProduct(from_pairs(products)) *
                           inverse_variance.cast<Complex>();
  stage.gradient =
      Map<const VectorXd>(reinterpret_cast<const double*>(scores.data()), 2 * scores.size());
  stage.usable = std::isfinite(stage.cost);
  return stage;
}

/// The linear filters of a fit, from errors of weighted FRFs to those of its parameters.
struct PoleFilter {
  PoleFilter(const FrfLines& data, const FrfNoise& noise, const ModalRefineResult& fit)
      : weight(line_weight(noise, data.H)),
        inverse_variance(inverse_variance_of(noise)),
        basis(stacked_basis(data.s, data.power, fit.poles, weight, data.background)),
        factor(gram_of(basis)) {
    if (!factor.usable()) return;
    const MatrixXd derivatives = stacked_pole_derivatives(data.s, data.power, fit.poles, weight);
    gain = factor.solve(basis.transpose() * derivatives);
    outside = derivatives - basis * gain;
    information = ScaledGram(summed_turns(gram_of(outside), fit.residues, inverse_variance));
  }
  [[nodiscard]] bool usable() const { return factor.usable() && information.usable(); }

  VectorXd weight, inverse_variance;
  MatrixXd basis;
  ScaledGram factor;  ///< Gram factor of the basis
  MatrixXd gain;
  MatrixXd outside;  ///< derivatives with respect to poles, less their part in the basis
  ScaledGram information = ScaledGram(MatrixXd(0, 0));
};

/// Rows of stacked columns times the root of each line's variance: weighted errors have the
/// variance a_c (w^2 q) at a line.
MatrixXd spread_rows(const PoleFilter& of, const FrfNoise& noise, const MatrixXd& columns) {
  const VectorXd spread = of.weight.cwiseProduct(noise.line.cwiseSqrt()).replicate(2, 1);
  return spread.asDiagonal() * columns;
}

/// From errors to residues at fixed poles: factor^-1 basis' error.
struct ResidueFilter {
  ResidueFilter(const PoleFilter& of, const FrfNoise& noise)
      : columns(spread_rows(of, noise, of.basis * of.factor.inverse())),
        covariance(columns.transpose() * correlated(noise, columns)) {}

  MatrixXd columns, covariance;
};

/// ModalCovariance::significance.
VectorXd significance_of(const Ref<const MatrixXcd>& model, const FrfNoise& noise,
                         const ModalRefineResult& fit, const ResidueFilter& filter) {
  const Index lines = model.rows();
  VectorXd significance = VectorXd::Zero(fit.poles.size());
  for (Index r = 0; r < significance.size(); ++r) {
    const Eigen::Matrix2d inverse = filter.covariance.block<2, 2>(2 * r, 2 * r).inverse();
    const VectorXd both = filter.columns.middleCols<2>(2 * r).rowwise().squaredNorm();
    const VectorXd share = (both.head(lines) + both.tail(lines)) / both.sum();
    for (Index c = 0; c < model.cols(); ++c) {
      const double variance =
          noise.column[c] + noise.common[c % noise.inputs()] * share.dot(model.col(c).cwiseAbs2());
      if (!(variance > 0 && std::isfinite(variance))) continue;
      const Eigen::Vector2d residue(fit.residues(r, c).real(), fit.residues(r, c).imag());
      significance[r] += residue.dot(inverse * residue) / variance;
    }
  }
  return significance;
}

/// X T: columns of the derivatives with respect to poles, turned by the residues of an FRF.
MatrixXd turned_columns(const MatrixXd& X, const Ref<const VectorXcd>& residues) {
  MatrixXd result(X.rows(), X.cols());
  for (Index r = 0; r < residues.size(); ++r) {
    const double a = residues[r].real(), b = residues[r].imag();
    result.col(2 * r) = a * X.col(2 * r) + b * X.col(2 * r + 1);
    result.col(2 * r + 1) = a * X.col(2 * r + 1) - b * X.col(2 * r);
  }
  return result;
}

/// Stacked columns as complex ones.
MatrixXcd unstacked(const Ref<const MatrixXd>& columns) {
  const Index lines = columns.rows() / 2;
  return columns.topRows(lines) + Complex(0, 1) * columns.bottomRows(lines);
}

/// sum_c conj(d model_c / d p_j) model_c / a_c at each line, over the FRFs of input `i`: what a
/// factor common to them adds to score j, as <column j, factor>. Stacked, 2 lines x parts of the
/// poles.
MatrixXd common_scores(const MatrixXcd& model, const MatrixXd& score, const MatrixXcd& residues,
                       const VectorXd& inverse_variance, Index inputs, Index i) {
  MatrixXcd sum = MatrixXcd::Zero(model.rows(), score.cols());
  for (Index c = i; c < model.cols(); c += inputs) {
    const VectorXcd weight = inverse_variance[c] * model.col(c).conjugate();
    sum += weight.asDiagonal() * unstacked(turned_columns(score, residues.col(c)));
  }
  return stacked(sum, VectorXd::Ones(sum.rows()));
}

/// Share of the freedom of each line that the fit uses, mean over FRFs.
VectorXd leverage_of(const PoleFilter& of, const FrfNoise& noise, const MatrixXcd& residues) {
  const Index lines = of.weight.size();
  const MatrixXd U = of.factor.orthonormal(of.basis), rho_U = correlated(noise, U);
  // 1 - diag((I - UU') rho (I - UU')).
  VectorXd both = 2 * U.cwiseProduct(rho_U).rowwise().sum() -
                  (U * (U.transpose() * rho_U)).cwiseProduct(U).rowwise().sum();
  if (of.information.usable() && residues.size() > 0) {
    // T covariance T' is the turn T' of the conjugate residues.
    const MatrixXd turned =
        summed_turns(of.information.inverse(), residues.conjugate(), of.inverse_variance);
    const auto frfs = std::max<Index>(1, (of.inverse_variance.array() > 0).count());
    both +=
        (of.outside * turned).cwiseProduct(of.outside).rowwise().sum() / static_cast<double>(frfs);
  }
  return 0.5 * (both.head(lines) + both.tail(lines));
}

}  // namespace

MatrixXcd fitted_frfs(const FrfLines& data, const ModalRefineResult& fit) {
  MatrixXcd H = synthesise(data.s, data.power, fit.poles, fit.residues, fit.lower, fit.upper);
  if (fit.background.size() > 0) H += data.background * fit.background;
  return H;
}

ModalRefineResult refine_modes(const FrfLines& data, const FrfNoise& noise,
                               const Ref<const VectorXcd>& start, PoleStepOptions steps) {
  const Index lines = data.s.size();
  const VectorXd weight = line_weight(noise, data.H);
  const MatrixXd y = stacked(data.H, weight);
  const VectorXd y_squared = y.colwise().squaredNorm().transpose();
  const VectorXd inverse_variance = inverse_variance_of(noise);
  const Index size = 2 * start.size();
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
  result.leverage = leverage_of(PoleFilter(data, noise, result), noise, result.residues);
  return result;
}

ModalCovariance modal_covariance(const FrfLines& data, const FrfNoise& noise,
                                 const ModalRefineResult& fit, bool significance_alone) {
  const Index modes = fit.poles.size(), size = 2 * modes, frfs = data.H.cols();
  const Index inputs = data.inputs;
  const PoleFilter of(data, noise, fit);
  ModalCovariance result;
  result.full_rank = of.usable();
  if (!result.full_rank || modes == 0) return result;
  const MatrixXcd model = fitted_frfs(data, fit);
  const ResidueFilter filter(of, noise);
  result.significance = significance_of(model, noise, fit, filter);
  if (significance_alone) return result;
  const auto& [weight, inverse_variance, basis, factor, gain, outside, information] = of;
  const MatrixXd score = spread_rows(of, noise, outside);
  MatrixXd middle =
      summed_turns(score.transpose() * correlated(noise, score), fit.residues, inverse_variance);
  for (Index i = 0; i < inputs; ++i) {
    if (!(noise.common[i] > 0)) continue;
    const MatrixXd common = common_scores(model, score, fit.residues, inverse_variance, inputs, i);
    middle += noise.common[i] * (common.transpose() * correlated(noise, common));
  }
  result.poles = information.solve(information.solve(middle).transpose());
  result.poles = (0.5 * (result.poles + result.poles.transpose())).eval();

  // The columns' filters see nothing of what moves the poles, where noise is independent of line
  // and FRF; else the covariance of the two parts is left out.
  result.residue_std_re.resize(modes, frfs);
  result.residue_std_im.resize(modes, frfs);
  const MatrixXcd columns = unstacked(filter.columns.leftCols(size));
  for (Index c = 0; c < frfs; ++c) {
    const MatrixXd through_poles = turned_columns(gain.topRows(size), fit.residues.col(c));
    VectorXd variance = (through_poles * result.poles).cwiseProduct(through_poles).rowwise().sum();
    if (inverse_variance[c] > 0) {
      variance += noise.column[c] * filter.covariance.diagonal().head(size);
    }
    if (const double common = noise.common[c % inputs]; common > 0) {
      const MatrixXcd with = model.col(c).conjugate().asDiagonal() * columns;
      const MatrixXd on_common = stacked(with, VectorXd::Ones(model.rows()));
      variance +=
          common * on_common.cwiseProduct(correlated(noise, on_common)).colwise().sum().transpose();
    }
    const MatrixXd std = variance.cwiseMax(0).cwiseSqrt().reshaped(2, modes);
    result.residue_std_re.col(c) = std.row(0);
    result.residue_std_im.col(c) = std.row(1);
  }
  return result;
}

MatrixXd pole_errors(const FrfLines& data, const FrfNoise& noise, const ModalRefineResult& fit,
                     const Ref<const MatrixXcd>& error) {
  const Index size = 2 * fit.poles.size();
  const PoleFilter filter(data, noise, fit);
  if (!filter.usable()) return {};
  const MatrixXd scores = filter.outside.transpose() * stacked(error, filter.weight);
  MatrixXcd turned = fit.residues.conjugate().cwiseProduct(from_pairs(scores)) *
                     filter.inverse_variance.asDiagonal();
  return filter.information.solve(
      Map<const MatrixXd>(reinterpret_cast<const double*>(turned.data()), size, turned.cols()));
}

}  // namespace rigfit::signal
