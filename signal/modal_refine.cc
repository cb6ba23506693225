#include "signal/modal_refine.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>

#include "signal/modal_basis.h"
#include "signal/residues.h"
#include "signal/scaled_gram.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// (a, b) of R = a + i b as the matrix [a -b; b a] that takes (Re, Im) of a pole's change to the
/// coordinates of the derivative columns, of all modes for one FRF: T' A T, T' v with A, v in
/// those.
MatrixXd turned(const MatrixXd& A, const Eigen::Ref<const VectorXd>& residues) {
  const Index size = A.rows();
  MatrixXd half(size, size), result(size, size);
  for (Index r = 0; r < size; r += 2) {
    const double a = residues[r], b = residues[r + 1];
    half.col(r) = a * A.col(r) + b * A.col(r + 1);
    half.col(r + 1) = -b * A.col(r) + a * A.col(r + 1);
  }
  for (Index r = 0; r < size; r += 2) {
    const double a = residues[r], b = residues[r + 1];
    result.row(r) = a * half.row(r) + b * half.row(r + 1);
    result.row(r + 1) = -b * half.row(r) + a * half.row(r + 1);
  }
  return result;
}

VectorXd turned_vector(const Eigen::Ref<const VectorXd>& v,
                       const Eigen::Ref<const VectorXd>& residues) {
  VectorXd result(v.size());
  for (Index r = 0; r < v.size(); r += 2) {
    const double a = residues[r], b = residues[r + 1];
    result[r] = a * v[r] + b * v[r + 1];
    result[r + 1] = -b * v[r] + a * v[r + 1];
  }
  return result;
}

/// X T: columns of X in derivative coordinates to columns in pole coordinates.
MatrixXd turned_columns(const MatrixXd& X, const Eigen::Ref<const VectorXd>& residues) {
  MatrixXd result(X.rows(), X.cols());
  for (Index r = 0; r < X.cols(); r += 2) {
    const double a = residues[r], b = residues[r + 1];
    result.col(r) = a * X.col(r) + b * X.col(r + 1);
    result.col(r + 1) = -b * X.col(r) + a * X.col(r + 1);
  }
  return result;
}

/// Everything about one set of poles that does not change with the FRF.
struct Stage {
  VectorXcd poles;
  MatrixXd basis, derivatives;  ///< stacked, weighted
  MatrixXd cross;               ///< basis' derivatives
  MatrixXd projected;           ///< Gram of the derivatives outside the basis
  MatrixXd coefficients;        ///< of the basis, a column an FRF
  double cost = 0;
  bool usable = false;
};

Stage stage_at(const FrfLines& data, const VectorXd& weight, const MatrixXd& y,
               const VectorXd& y_squared, const VectorXd& inverse_variance,
               const VectorXcd& poles) {
  Stage stage;
  stage.poles = poles;
  stage.basis = stacked_basis(data.s, data.power, poles, weight);
  const ScaledGram factor(gram_of(stage.basis));
  if (!factor.usable()) return stage;
  const MatrixXd moments = stage.basis.transpose() * y;
  stage.coefficients = factor.solve(moments);
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

VectorXd inverse_of(const VectorXd& variance) {
  return variance.unaryExpr([](double v) { return std::isfinite(v) && v > 0 ? 1 / v : 0.0; });
}

/// Sum over FRFs of the information about the poles.
MatrixXd pole_information(const Stage& stage, const VectorXd& inverse_variance) {
  const Index size = stage.projected.rows();
  MatrixXd information = MatrixXd::Zero(size, size);
  for (Index c = 0; c < stage.coefficients.cols(); ++c) {
    if (inverse_variance[c] == 0) continue;
    information +=
        inverse_variance[c] * turned(stage.projected, stage.coefficients.col(c).head(size));
  }
  return information;
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

  const ScaledGram information(pole_information(stage, inverse_variance));
  if (!information.usable()) return leverage;
  if (size == 0) return leverage;
  const MatrixXd outside = stage.derivatives - stage.basis * factor.solve(stage.cross);
  const MatrixXd covariance = information.inverse();
  MatrixXd turned_sum = MatrixXd::Zero(size, size);
  for (Index c = 0; c < stage.coefficients.cols(); ++c) {
    // T covariance T' is the transpose's turn: T' of the conjugate residue.
    VectorXd conjugate = stage.coefficients.col(c).head(size);
    for (Index r = 1; r < size; r += 2) conjugate[r] = -conjugate[r];
    turned_sum += inverse_variance[c] * turned(covariance, conjugate);
  }
  const VectorXd poles = (outside * turned_sum).cwiseProduct(outside).rowwise().sum();
  const double frfs =
      static_cast<double>(std::max<Index>(1, (inverse_variance.array() > 0).count()));
  return leverage + 0.5 * (poles.head(lines) + poles.tail(lines)) / frfs;
}

/// What is left of a mode's significance when noise common to the FRFs of input `i` may imitate it:
/// the errors of its residues have, besides the FRFs' own, a part along the FRFs at the line that
/// weighs most (Sherman-Morrison for that rank one). `share`: |filter|^2 of the mode's residue by
/// line.
double outside_common_noise(const MatrixXcd& model, const FrfNoise& noise,
                            const VectorXd& inverse_variance, const VectorXd& share,
                            const Eigen::RowVectorXcd& residue, double length, Index i) {
  if (!(noise.common[i] > 0) || !(length > 0)) return 1;
  const Index inputs = noise.inputs();
  VectorXd h = VectorXd::Zero(model.rows());
  for (Index c = i; c < model.cols(); c += inputs) {
    h += inverse_variance[c] * model.col(c).cwiseAbs2();
  }
  Index most = 0;
  if (!(share.cwiseProduct(h).maxCoeff(&most) > 0)) return 1;
  const double strength = noise.common[i] * share.dot(h) / (share.sum() * h[most]);
  Complex along = 0;
  for (Index c = i; c < model.cols(); c += inputs) {
    along += inverse_variance[c] * std::conj(residue[c]) * model(most, c);
  }
  return 1 - strength * std::norm(along) / (length * (1 + strength * h[most]));
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
  const VectorXd inverse_variance = inverse_of(noise.column);
  const double window = lines > 0 ? data.s[0].real() : 0;
  const Index size = 2 * start.size();
  const double freedom = std::max(1.0, static_cast<double>((inverse_variance.array() > 0).count()) *
                                               static_cast<double>(2 * lines - size - 4) -
                                           static_cast<double>(size));

  ModalRefineResult result;
  Stage stage = stage_at(data, weight, y, y_squared, inverse_variance, start);
  if (!stage.usable) result.end = RefineEnd::rank_deficient;
  while (stage.usable && size > 0 && result.iterations < options.max_iterations) {
    ++result.iterations;
    // basis' residual = 0, so the gradient is derivatives' residual.
    const MatrixXd gradient_all =
        stage.derivatives.transpose() * y - stage.cross.transpose() * stage.coefficients;
    VectorXd gradient = VectorXd::Zero(size);
    for (Index c = 0; c < data.H.cols(); ++c) {
      if (inverse_variance[c] == 0) continue;
      gradient += inverse_variance[c] *
                  turned_vector(gradient_all.col(c), stage.coefficients.col(c).head(size));
    }
    const MatrixXd information = pole_information(stage, inverse_variance);
    const ScaledGram factor(information);
    if (!factor.usable()) {
      result.end = RefineEnd::rank_deficient;
      break;
    }
    VectorXd step = factor.solve_vector(gradient);
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
      result.end = small || relative < 1e-9 ? RefineEnd::converged : RefineEnd::no_descent;
      break;
    }
  }
  result.poles = stage.poles;
  if (!stage.usable) return result;
  if (size == 0) result.end = RefineEnd::converged;
  unpack_coefficients(stage.coefficients, result.residues, result.lower, result.upper);
  result.cost = stage.cost;
  result.leverage = leverage_of(stage, noise, inverse_variance);
  return result;
}

ModalCovariance modal_covariance(const FrfLines& data, const FrfNoise& noise,
                                 const ModalRefineResult& fit) {
  const Index modes = fit.poles.size(), size = 2 * modes, frfs = data.H.cols();
  const Index inputs = data.inputs, lines = data.s.size();
  const MatrixXcd model =
      synthesise(data.s, data.power, fit.poles, fit.residues, fit.lower, fit.upper);
  const VectorXd weight = line_weight(noise, data.H);
  const VectorXd inverse_variance = inverse_of(noise.column);
  ModalCovariance result;
  result.full_rank = false;

  const MatrixXd basis = stacked_basis(data.s, data.power, fit.poles, weight);
  const ScaledGram factor(gram_of(basis));
  if (!factor.usable()) return result;
  Stage stage;
  stage.coefficients = pack_coefficients(fit.residues, fit.lower, fit.upper);
  stage.derivatives = stacked_pole_derivatives(data.s, data.power, fit.poles, weight);
  stage.cross = basis.transpose() * stage.derivatives;
  const MatrixXd gain = factor.solve(stage.cross);
  const MatrixXd outside = stage.derivatives - basis * gain;
  stage.projected = gram_of(outside);
  const ScaledGram information(pole_information(stage, inverse_variance));
  if (!information.usable()) return result;
  result.full_rank = true;
  if (modes == 0) {
    result.poles.resize(0, 0);
    result.significance.resize(0);
    return result;
  }

  // Weighted errors have the variance a_c (w^2 q) at a line: rows of what they multiply take its
  // root.
  const VectorXd spread = weight.cwiseProduct(noise.line.cwiseSqrt());
  const auto spread_rows = [&](MatrixXd m) {
    m.topRows(lines) = spread.asDiagonal() * m.topRows(lines);
    m.bottomRows(lines) = spread.asDiagonal() * m.bottomRows(lines);
    return m;
  };
  const MatrixXd score = spread_rows(outside);
  const MatrixXd score_covariance = score.transpose() * correlated(noise, score);
  MatrixXd middle = MatrixXd::Zero(size, size);
  for (Index c = 0; c < frfs; ++c) {
    if (inverse_variance[c] == 0) continue;
    middle += inverse_variance[c] * turned(score_covariance, stage.coefficients.col(c).head(size));
  }
  for (Index i = 0; i < inputs; ++i) {
    if (!(noise.common[i] > 0)) continue;
    // sum_c conj(d model_c / d p_j) model_c / a_c at each line: what the common factor adds to
    // score j.
    MatrixXcd sums = MatrixXcd::Zero(lines, size);  // sum_c model_c * residue coefficient / a_c
    for (Index c = i; c < frfs; c += inputs) {
      if (inverse_variance[c] == 0) continue;
      sums += inverse_variance[c] * model.col(c) *
              stage.coefficients.col(c).head(size).transpose().cast<Complex>();
    }
    MatrixXd common(2 * lines, size);
    for (Index j = 0; j < size; ++j) {
      const Index r = j - j % 2;
      // Column j of T: (a, b) for the real part, (-b, a) for the imaginary part of the pole.
      VectorXcd total = VectorXcd::Zero(lines);
      for (Index e = 0; e < 2; ++e) {
        const double sign = j % 2 == 1 && e == 0 ? -1 : 1;
        const auto factor_column = sums.col(j % 2 == 0 ? r + e : r + 1 - e);
        VectorXcd derivative(lines);
        derivative.real() = score.col(r + e).head(lines);
        derivative.imag() = score.col(r + e).tail(lines);
        total += sign * derivative.conjugate().cwiseProduct(factor_column);
      }
      // Re(total * factor) = <conj(total), factor> in stacked parts.
      common.col(j).head(lines) = total.real();
      common.col(j).tail(lines) = -total.imag();
    }
    common *= std::sqrt(noise.common[i]);
    middle += common.transpose() * correlated(noise, common);
  }
  result.poles = information.solve(information.solve(middle).transpose());
  result.poles = (0.5 * (result.poles + result.poles.transpose())).eval();

  // Residues at fixed poles: factor^-1 basis' error; then what the poles' scatter adds.
  const MatrixXd filter = spread_rows(basis * factor.inverse());
  const MatrixXd filter_covariance = filter.transpose() * correlated(noise, filter);
  const VectorXd widened = filter_covariance.diagonal().cwiseQuotient(
      filter.colwise().squaredNorm().transpose().cwiseMax(1e-300));
  const MatrixXd filter_squared =
      filter.topRows(lines).cwiseAbs2() + filter.bottomRows(lines).cwiseAbs2();
  const MatrixXd common_variance = noise.common.maxCoeff() > 0
                                       ? MatrixXd(filter_squared.transpose() * model.cwiseAbs2())
                                       : MatrixXd::Zero(size + 4, frfs);
  result.residue_std_re.resize(modes, frfs);
  result.residue_std_im.resize(modes, frfs);
  result.significance = VectorXd::Zero(modes);
  for (Index c = 0; c < frfs; ++c) {
    const MatrixXd through_poles = turned_columns(gain, stage.coefficients.col(c).head(size));
    const VectorXd pole_part =
        (through_poles * result.poles).cwiseProduct(through_poles).rowwise().sum();
    const double own = inverse_variance[c] > 0 ? noise.column[c] : 0;
    for (Index r = 0; r < modes; ++r) {
      double variance[2];
      for (Index e = 0; e < 2; ++e) {
        const Index j = 2 * r + e;
        variance[e] = own * filter_covariance(j, j) + pole_part[j] +
                      noise.common[c % inputs] * widened[j] * common_variance(j, c);
      }
      result.residue_std_re(r, c) = std::sqrt(variance[0]);
      result.residue_std_im(r, c) = std::sqrt(variance[1]);
    }
  }
  for (Index r = 0; r < modes; ++r) {
    const Eigen::Matrix2d block = filter_covariance.block<2, 2>(2 * r, 2 * r);
    Eigen::Matrix2d inverse;
    inverse << block(1, 1), -block(0, 1), -block(1, 0), block(0, 0);
    inverse /= block(0, 0) * block(1, 1) - block(0, 1) * block(1, 0);
    const VectorXd share = 0.5 * (filter_squared.col(2 * r) + filter_squared.col(2 * r + 1));
    for (Index i = 0; i < inputs; ++i) {
      double own = 0, length = 0;
      for (Index c = i; c < frfs; c += inputs) {
        const Eigen::Vector2d residue = stage.coefficients.col(c).segment<2>(2 * r);
        own += inverse_variance[c] * residue.dot(inverse * residue);
        length += inverse_variance[c] * residue.squaredNorm();
      }
      result.significance[r] += own * outside_common_noise(model, noise, inverse_variance, share,
                                                           fit.residues.row(r), length, i);
    }
  }
  return result;
}

}  // namespace rigfit::signal
